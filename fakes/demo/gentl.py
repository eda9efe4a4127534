"""A demonstration whose images come through the fake GenTL producer, harvesters and `gige`."""

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from fakes.gentl.build import NAME, NoCompilerError, build_producer
from fakes.gentl.cameras import FakeCamera
from fakes.gentl.shown import shown
from fakes.scenario_file.scenario import Scenario

Cameras = Literal["gentl", "frame-server"]
"""How the images of the fake cell come to the daemon."""

_SECTIONS = ("stereo_cameras", "cameras")
_DRIVER, _REPLACED = "gige", "frame-server"
_DRIVER_LINE = re.compile(rf'^driver *= *"{_REPLACED}"', re.MULTILINE)
_SETTINGS_LINE = re.compile(r"^settings *= *\{[^\n]*\}", re.MULTILINE)
_BETWEEN_TRIGGERS_S = 0.5
"""A real pair of cameras has 5 ms; fake cell, renderer and daemon share two processors."""
_REPLY_TIMEOUT_S = 60.0


class UnusualCellFile(RuntimeError):
    """The cell file is not written so that its cameras can be replaced line by line."""


@dataclass(frozen=True, slots=True)
class GentlPath:
    """What fake cell and daemon need for this path of the images."""

    cameras: Path
    """The file that shows the cameras to the producer; the fake cell writes it."""
    cell: Path
    """The cell file with the driver `gige` in place of frame servers."""


def way_of_images(
    wanted: Cameras | None, cell: Path, load: Callable[[], Scenario], folder: Path
) -> tuple[GentlPath | None, str]:
    """How images come, and a sentence for the user where there is a choice; None: as they did.

    Without a wish it is the producer, where this computer can build it. ``load`` reads the
    scenario, ``folder`` takes what is made. Raises ``NoCompilerError`` and ``UnusualCellFile`` for
    a wish that cannot be met.
    """
    written = _read(cell)
    if not any(True for _ in _frame_servers(written)):
        return None, ""
    if wanted == "frame-server":
        return None, "images come from frame servers"
    scenario = load()
    if wanted is None and (name := _head_with_one_number(scenario)):
        return None, (
            f"{name} has one serial number, which its calibrations name: images come from frame "
            "servers. With those of both its cameras (LEFT+RIGHT) they would come through GenTL"
        )
    try:
        path = _prepared(written, cell.absolute(), scenario, folder.absolute())
    except (NoCompilerError, UnusualCellFile) as error:
        if wanted is not None:
            raise
        reason = str(error).partition("\n")[0]
        return None, f"{reason}: images come from frame servers, not through GenTL"
    return path, "images come through a GenTL producer, as from GigE cameras"


def _head_with_one_number(scenario: Scenario) -> str:
    """The head of the scenario that has one serial number; images of a producer do not suit it.

    Behind a producer it would get another number, and no calibration would fit it any more.
    """
    heads = scenario.stereo_cameras.items()
    return next((name for name, head in heads if "+" not in head.serial), "")


def _read(cell: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(cell.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}  # the daemon says what is wrong with it


def _prepared(written: dict[str, Any], cell: Path, scenario: Scenario, folder: Path) -> GentlPath:
    """The producer compiled, and the cell file written where its relative paths hold too."""
    state, producer = folder / "cameras", folder / NAME
    text = _with_gige_cameras(cell, written, scenario, producer)
    folder.mkdir(exist_ok=True)
    # Named in the producer itself, so that every program that loads it finds the same cameras.
    build_producer(folder, f'-DSTATE_FILE="{state}"')
    changed = _beside_the_same_files(cell, folder / "cell")
    changed.write_text(text, encoding="utf-8")
    return GentlPath(state, changed)


def _with_gige_cameras(
    cell: Path, written: dict[str, Any], scenario: Scenario, producer: Path
) -> str:
    """The text of a cell file with other cameras. Raises ``UnusualCellFile``."""
    text, there = cell.read_text(encoding="utf-8"), shown(scenario)
    for section, device in _frame_servers(written):
        name = section.rpartition(".")[2]
        if name not in there:
            continue  # the daemon says that it does not answer
        patience_s = device.get("settings", {}).get("reply_timeout_s", _REPLY_TIMEOUT_S)
        device["driver"] = _DRIVER
        device["settings"] = {
            **_chosen(there[name]),
            "producers": [str(producer)],
            "pixel_format": there[name][0].pixel_format,
            "exposure_s": scenario.optics_of(name).exposure_us / 1e6,
            "connect_timeout_s": _REPLY_TIMEOUT_S,
            "image_timeout_s": patience_s,
            "tries": 1,
        }
        text = _edited(text, section, device["settings"])
    # Edited as text, so that comments and line numbers stay, and checked as data: a file that is
    # written in another way must not be changed by half.
    if tomllib.loads(text) != written:
        raise UnusualCellFile(
            f"{cell} does not have driver and settings of each camera in one line of its section"
        )
    return text


def _beside_the_same_files(cell: Path, folder: Path) -> Path:
    """A place for another cell file, with links to what lies beside this one."""
    folder.mkdir(exist_ok=True)
    for path in cell.parent.iterdir():
        link = folder / path.name
        if path != cell and path not in folder.parents and not link.is_symlink():
            link.symlink_to(path)
    return folder / cell.name


def _frame_servers(written: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for section in _SECTIONS:
        for name, device in written.get(section, {}).items():
            if device.get("driver") == _REPLACED and device.get("simulated") is True:
                yield f"{section}.{name}", device


def _chosen(lenses: tuple[FakeCamera, ...]) -> dict[str, Any]:
    """Which cameras the device is made of."""
    names = ("camera",) if len(lenses) == 1 else ("left", "right")
    chosen: dict[str, Any] = {
        name: {"serial_number": lens.serial} for name, lens in zip(names, lenses, strict=True)
    }
    return chosen if len(lenses) == 1 else chosen | {"max_difference_s": _BETWEEN_TRIGGERS_S}


def _edited(text: str, section: str, settings: Mapping[str, Any]) -> str:
    """The text with another driver in one section; every other line stays where it is.

    So what the daemon says of a line of the cell file holds for the user's own file too.
    """
    header, begin, rest = text.partition(f"[{section}]\n")
    body, end, after = rest.partition("\n[")
    body = _DRIVER_LINE.sub(f'driver = "{_DRIVER}"', body, count=1)
    body = _SETTINGS_LINE.sub(lambda _: f"settings = {_toml(settings)}", body, count=1)
    return header + begin + body + end + after


def _toml(value: Any) -> str:
    """A value in one line; strings, numbers and truth values are those of JSON."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_toml(key)} = {_toml(value[key])}" for key in value) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
