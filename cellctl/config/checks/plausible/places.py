"""Folders and host names that were misspelt, and folders that a daemon may not write."""

import re
from collections.abc import Iterator
from pathlib import Path

from cellctl.config.cell import CellConfig
from cellctl.config.checks.hosts import is_address, written_hosts
from cellctl.config.issue import ConfigIssue
from cellctl.spelling import nearest

_ALIKE = 0.9
"""Likeness of two names from which on one is taken for the other mistyped: one letter of ten, so
that folders named by one pattern pass."""
_ALIKE_HOST = 0.8
_SYSTEM = ("/etc", "/usr", "/bin", "/sbin", "/lib", "/boot", "/proc", "/sys", "/dev")
"""What the daemon's unit lets nobody write (ProtectSystem=strict), and what no data belong into."""


def place_issues(cell: CellConfig, folder: Path) -> Iterator[ConfigIssue]:
    """``folder`` is that of the cell file. Nothing is looked up in a network."""
    yield from _folders(cell, folder)
    yield from _hosts(cell)


def _folders(cell: CellConfig, folder: Path) -> Iterator[ConfigIssue]:
    for key in ("data_dir", "calibration_dir"):
        if not getattr(cell, key).strip():
            yield ConfigIssue(key, repr(getattr(cell, key)), "a folder, which is made if need be")
    yield from _of_the_system(cell, folder)
    calibrations = folder / cell.calibration_dir
    parent = calibrations.parent
    # A new cell has no such folder yet. One that resembles a folder which is there, and would be
    # made beside it, is that folder misspelt: the cell would have lost its calibrations.
    if cell.calibration_dir.strip() and not calibrations.exists() and parent.is_dir():
        there = [one.name for one in parent.iterdir() if one.is_dir()]
        # Folders of several cells differ by their numbers.
        others = [name for name in there if _letters(name) != _letters(calibrations.name)]
        if said := nearest(calibrations.name, others, least_ratio=_ALIKE):
            allowed = f"{said}no such folder beside it; make it if another one is meant"
            yield ConfigIssue("calibration_dir", repr(cell.calibration_dir), allowed)


def _of_the_system(cell: CellConfig, folder: Path) -> Iterator[ConfigIssue]:
    written = {"data_dir": Path(cell.data_dir), "calibration_dir": folder / cell.calibration_dir}
    meant = {"data_dir": "/var/lib/cellctl", "calibration_dir": "/var/lib/cellctl/calibration"}
    for key, path in written.items():
        place = path.absolute()
        if any(place.is_relative_to(system) for system in _SYSTEM):
            allowed = f"a folder that the daemon may write, such as '{meant[key]}'; not {place}"
            yield ConfigIssue(key, repr(getattr(cell, key)), allowed)


def _letters(name: str) -> str:
    return re.sub(r"\d", "", name)


def _hosts(cell: CellConfig) -> Iterator[ConfigIssue]:
    for key, host in written_hosts(cell).items():
        if (
            host != "localhost"
            and not is_address(host)
            and (said := nearest(host, ["localhost"], least_ratio=_ALIKE_HOST))
        ):
            yield ConfigIssue(key, repr(host), f"{said}an address or the name of a device")
