"""What a demonstration may touch: cells whose devices are all fakes, and no other."""

import shutil
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

_NOT_DEVICES = ("processes", "recipes")
"""Sections of the cell file whose keys are those of the processes."""


class NotSimulated(RuntimeError):
    """The cell file has real devices."""


class UnfitCell(RuntimeError):
    """No cell file, or that of another process."""


class FolderInUse(RuntimeError):
    """The folder for record and logs holds what no demonstration has made."""


def require_simulated(cell: Path) -> Mapping[str, Any] | None:
    """The content of a cell file all of whose devices are fakes; raises ``NotSimulated``.

    None for a file that cannot be read or names no device: the daemon says what is wrong with it.
    """
    try:
        written = tomllib.loads(cell.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    devices = dict(_devices(written, ""))
    if real := [name for name, simulated in devices.items() if not simulated]:
        raise NotSimulated(
            f"{cell} is the cell file of a real cell: {', '.join(real)} "
            f"{'is' if len(real) == 1 else 'are'} not marked 'simulated = true'. "
            "The demonstration runs on fake devices only"
        )
    return written if devices else None


def own_calibrations(cell: Path, folder: Path) -> Path | None:
    """Copy the calibrations of a cell of fakes into a folder of a demonstration; where they lie.

    The demonstration works on the copy, so nothing of the cell file's folder is ever changed. Notes
    that a calibration is invalid stay behind: the devices of a new fake cell are again as its
    hardware seed draws them, and such a note is about devices that exist no more. None where the
    cell file cannot be read, or names no device. Raises ``NotSimulated``, and touches nothing then.
    """
    written = require_simulated(cell)
    if written is None:
        return None
    shipped = cell.parent / str(written.get("calibration_dir", "calibration"))
    own = folder / "calibration"
    if own.exists():
        return own  # of the same demonstration, which goes on
    own.mkdir(parents=True)
    for file in sorted(shipped.glob("*.json")) + sorted(shipped.glob("*.png")):
        if not file.name.endswith(".invalidated.json"):
            shutil.copyfile(file, own / file.name)
    return own


def require_own_folder(folder: Path) -> None:
    """Raise ``FolderInUse`` for a folder that may hold the records of a real cell."""
    if folder.is_dir() and any(folder.iterdir()) and not (folder / "fake-cell.log").exists():
        raise FolderInUse(f"{folder} holds files that no demonstration has made; choose another")


def _devices(table: Mapping[str, Any], path: str) -> Iterator[tuple[str, bool]]:
    """Every table with a driver, stop channels included, and whether it is marked as a fake."""
    for key, value in table.items():
        if not isinstance(value, dict) or (not path and key in _NOT_DEVICES):
            continue
        place = f"{path}.{key}" if path else key
        if "driver" in value:
            yield place, value.get("simulated") is True
        yield from _devices(value, place)
