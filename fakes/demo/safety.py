"""What a demonstration may touch: cells whose devices are all fakes, and no other."""

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

_NOT_DEVICES = ("processes", "recipes")
"""Sections of the cell file whose keys are those of the processes."""


class NotSimulated(RuntimeError):
    """The cell file has real devices."""


def as_drawn(cell: Path) -> None:
    """Undo what an earlier fake cell suffered, and the daemon held against its calibrations.

    The devices of a new fake cell are again as its hardware seed draws them, so a note that a
    calibration is invalid is about devices that exist no more. With real devices that note is the
    truth: raises ``NotSimulated`` and touches nothing.
    """
    try:
        written = tomllib.loads(cell.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return  # the daemon says what is wrong with it
    devices = dict(_devices(written, ""))
    if real := [name for name, simulated in devices.items() if not simulated]:
        raise NotSimulated(
            f"{cell} is the cell file of a real cell: {', '.join(real)} "
            f"{'is' if len(real) == 1 else 'are'} not marked 'simulated = true'. "
            "The demonstration runs on fake devices only"
        )
    if devices:
        folder = cell.parent / str(written.get("calibration_dir", "calibration"))
        for marker in folder.glob("*.invalidated.json"):
            marker.unlink()


def _devices(table: Mapping[str, Any], path: str) -> Iterator[tuple[str, bool]]:
    """Every table with a driver, stop channels included, and whether it is marked as a fake."""
    for key, value in table.items():
        if not isinstance(value, dict) or (not path and key in _NOT_DEVICES):
            continue
        place = f"{path}.{key}" if path else key
        if "driver" in value:
            yield place, value.get("simulated") is True
        yield from _devices(value, place)
