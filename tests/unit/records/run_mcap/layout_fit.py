"""Whether a layout of Foxglove fits a recording: what each kind of panel asks of the file.

Foxglove itself does not run here. What its panels take is written in its documentation: Image,
3D, Plot, State Transitions and Log panel, and the schemas RawImage, CompressedImage,
ImageAnnotations, PoseInFrame, FrameTransforms and Log.
"""

import re
from collections.abc import Iterator
from typing import Any

from tests.unit.records.run_mcap.reading import Content

IMAGES = {"foxglove.RawImage", "foxglove.CompressedImage"}
PLACED = {"foxglove.PoseInFrame", "foxglove.PosesInFrame", "foxglove.SceneUpdate"}
ENCODINGS = {"mono8": 1, "8UC1": 1, "mono16": 2, "16UC1": 2, "rgb8": 3, "bgr8": 3}
FORMATS = {"jpeg", "png", "webp", "avif"}


def misfits(layout: dict[str, Any], content: Content) -> list[str]:
    """What the panels of the layout do not find in the recording, or find in another form."""
    panels = layout["configById"]
    found = [f"{name} is not placed" for name in set(panels) ^ set(_placed(layout["layout"]))]
    known = {"Image": _image, "3D": _scene, "Plot": _plot, "StateTransitions": _states}
    known["RosOut"] = _log
    for name, settings in panels.items():
        kind, _, rest = name.partition("!")
        if kind not in known or not rest:
            found.append(f"{name} is no panel")
        else:
            found += [f"{name}: {problem}" for problem in known[kind](settings, content)]
    return found


def _placed(node: Any) -> list[str]:
    """Each panel once: the tree of Foxglove has two children at every branch."""
    if isinstance(node, str):
        return [node]
    assert node["direction"] in ("row", "column")
    return _placed(node["first"]) + _placed(node["second"])


def _image(settings: dict[str, Any], content: Content) -> Iterator[str]:
    mode = settings["imageMode"]
    topic = mode["imageTopic"]
    if content.schemas.get(topic) not in IMAGES:
        yield f"{topic} is no image"
    for message in content.of(topic):
        yield from _pixels(message)
    for drawn in mode["annotations"]:
        if content.schemas.get(drawn) != "foxglove.ImageAnnotations":
            yield f"{drawn} has no annotations"


def _pixels(message: Any) -> Iterator[str]:
    if message.DESCRIPTOR.name == "CompressedImage":
        if message.format not in FORMATS:
            yield f"format {message.format}"
        return
    size = ENCODINGS.get(message.encoding)
    if size is None:
        yield f"encoding {message.encoding}"
    elif message.step < message.width * size or len(message.data) != message.step * message.height:
        yield f"{len(message.data)} bytes for {message.width} x {message.height}"


def _scene(settings: dict[str, Any], content: Content) -> Iterator[str]:
    frames = {
        frame
        for message in content.of("/tf")
        for one in message.transforms
        for frame in (one.parent_frame_id, one.child_frame_id)
    }
    if frames and settings.get("followTf") not in frames:
        yield f"no frame {settings.get('followTf')}"
    for topic in settings["topics"]:
        if content.schemas.get(topic) not in PLACED:
            yield f"{topic} has no place in 3D"
        strange = {message.frame_id for message in content.of(topic)} - frames
        if strange:
            yield f"{topic} is in {sorted(strange)}, which /tf has not"


def _plot(settings: dict[str, Any], content: Content) -> Iterator[str]:
    for path in settings["paths"]:
        values = _values(path["value"], content)
        if not any(isinstance(one, int | float) and not isinstance(one, bool) for one in values):
            yield f"{path['value']} has no number"


def _states(settings: dict[str, Any], content: Content) -> Iterator[str]:
    for path in settings["paths"]:
        values = _values(path["value"], content)
        if not values or not all(isinstance(one, str | int | bool) for one in values):
            yield f"{path['value']} has no state"


def _values(path: str, content: Content) -> list[Any]:
    """Of a message path, as far as the layout uses its grammar: a topic and names of fields."""
    match = re.fullmatch(r"(/[\w/-]+)((?:\.\w+)+)", path)
    if match is None:
        return []
    found = content.of(match[1])
    for key in match[2].strip(".").split("."):
        found = [one[key] for one in found if isinstance(one, dict) and key in one]
    return found


def _log(settings: dict[str, Any], content: Content) -> Iterator[str]:
    if content.schemas.get(settings["topicToRender"]) != "foxglove.Log":
        yield f"{settings['topicToRender']} is no log"
