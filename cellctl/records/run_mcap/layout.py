"""A layout of Foxglove for one exported run: its images, forces, states, poses and log.

The form is that of layouts that are exported as files, which Foxglove and Lichtblick both import.
"""

import json
from collections.abc import Collection, Iterable
from typing import Any

Panel = tuple[str, dict[str, Any]]
"""Name of the panel, kind first, and its settings."""
_WRENCH = ("fx_n", "fy_n", "fz_n")
_MOST_IMAGES = 4
"""Panels of images beside each other: what fits a screen, and both sides of two heads."""
BASE = "base"


def layout_for(topics: Iterable[str], frames: Collection[str]) -> str:
    """The layout as JSON; names no topic and no frame that the run does not have."""
    known = sorted(topics)
    left = [*_images(known), _scene(known, frames)]
    right = [*_plots(known), _states(known), _log()]
    panels = [*left, *right]
    document = {
        "configById": dict(panels),
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _beside(_stacked(_paired(left)), _stacked([name for name, _ in right])),
    }
    return json.dumps(document, indent=1) + "\n"


def _images(topics: list[str]) -> list[Panel]:
    views = [one for one in topics if one.startswith("/images/") and one.count("/") == 2]
    found = []
    for topic in views[:_MOST_IMAGES]:
        drawn = f"{topic}/annotations"
        annotations = {drawn: {"visible": True}} if drawn in topics else {}
        name = topic.rsplit("/", 1)[-1]
        mode = {"imageTopic": topic, "annotations": annotations, "synchronize": False}
        found.append((f"Image!{name}", {"imageMode": mode, "foxglovePanelTitle": name}))
    return found


def _scene(topics: list[str], frames: Collection[str]) -> Panel:
    shown = [one for one in topics if one.startswith("/poses/") or one.endswith("/target")]
    settings = {
        "topics": {topic: {"visible": True} for topic in shown},
        **_followed(frames),
        "scene": {"transforms": {"axisScale": 0.3}},
        "layers": {},
    }
    return "3D!scene", settings


def _followed(frames: Collection[str]) -> dict[str, str]:
    """The base of the robot that a process works with; a run that names none has those of all."""
    bases = [BASE] if BASE in frames else sorted(one for one in frames if one.endswith(f"/{BASE}"))
    return {"followTf": bases[0]} if bases else {}


def _plots(topics: list[str]) -> list[Panel]:
    forces = [one for one in topics if one == "/contact/force" or one.startswith("/force/")]
    found = [
        (f"Plot!{topic.strip('/').replace('/', '-')}", _plot(topic, _WRENCH, topic))
        for topic in forces
    ]
    if "/passes" in topics:
        axes = [f"components.{axis}.value" for axis in ("X", "Y", "Z", "rx", "ry", "rz")]
        found.append(("Plot!passes", _plot("/passes", axes, "error of each pass, mm and °")))
    return found


def _plot(topic: str, fields: Iterable[str], title: str) -> dict[str, Any]:
    paths = [
        {
            "value": f"{topic}.{field}",
            "label": field,
            "enabled": True,
            "timestampMethod": "receiveTime",
        }
        for field in fields
    ]
    return {
        "paths": paths,
        "foxglovePanelTitle": title,
        "showLegend": True,
        "legendDisplay": "floating",
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "isSynced": True,
        "xAxisVal": "timestamp",
    }


def _states(topics: list[str]) -> Panel:
    wanted = (("/unit/state", "state"), ("/unit/state", "mode"), ("/steps", "label"))
    paths = [
        {"value": f"{topic}.{field}", "label": field, "timestampMethod": "receiveTime"}
        for topic, field in wanted
        if topic in topics
    ]
    return "StateTransitions!states", {"paths": paths, "isSynced": True}


def _log() -> Panel:
    return "RosOut!log", {"topicToRender": "/log", "searchTerms": [], "minLogLevel": 1}


def _paired(panels: list[Panel]) -> list[Any]:
    """Two images side by side in each row, the rest alone."""
    names = [name for name, _ in panels]
    pairs = [names[index : index + 2] for index in range(0, len(names), 2)]
    return [_beside(*pair) if len(pair) == 2 else pair[0] for pair in pairs]


def _beside(first: Any, second: Any) -> dict[str, Any]:
    return {"direction": "row", "first": first, "second": second, "splitPercentage": 50}


def _stacked(rows: list[Any]) -> Any:
    if len(rows) == 1:
        return rows[0]
    share = 100 / len(rows)
    return {
        "direction": "column",
        "first": rows[0],
        "second": _stacked(rows[1:]),
        "splitPercentage": round(share, 1),
    }
