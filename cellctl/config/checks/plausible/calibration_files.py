"""Calibration files that the daemon would refuse, and those that it will refuse soon.

Checks that hold a cell file against stored calibrations pass over a file that cannot be read. What
nobody says of it, the first Start does.
"""

from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

from cellctl.calibration.store.envelope import read_stored
from cellctl.calibration.store.marker import require_not_invalidated
from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.process_definition import process_definition
from cellctl.errors import CellError

_KEY = "calibration_dir"


def calibration_file_issues(cell: CellConfig, folder: Path) -> Iterator[ConfigIssue]:
    """Files that were changed, cut off, renamed or exchanged; ``folder`` is of the cell file."""
    for place, kind in _kept(cell, folder):
        try:
            read_stored(place, kind)
        except CellError as error:
            allowed = f"{error.text}: {error.detail}. {error.remedy}"
            yield ConfigIssue(
                _KEY, repr(f"{cell.calibration_dir}/{kind}.json"), allowed, error.number
            )


def calibration_file_remarks(
    cell: CellConfig, folder: Path, now: datetime
) -> Iterator[ConfigIssue]:
    """Good files that do not serve Production: expired, invalidated, or of a later time."""
    for place, kind in _kept(cell, folder):
        try:
            stored = read_stored(place, kind)
            require_not_invalidated(place, kind)
            stored.require_past(now)
        except CellError as error:
            said = f"F{error.number} {error.text}: {error.detail}"
        else:
            if stored.valid_until > now:
                continue
            said = f"expired on {stored.valid_until:%Y-%m-%d}; make it again"
        yield ConfigIssue(_KEY, repr(f"{cell.calibration_dir}/{kind}.json"), said)


def _kept(cell: CellConfig, folder: Path) -> Iterator[tuple[Path, str]]:
    """Calibrations of this cell that are there: their folder and their names."""
    if not cell.calibration_dir.strip():
        return
    place = folder / cell.calibration_dir
    known = {name for process in cell.processes for name in process_definition(process).stores}
    for path in sorted(place.glob("*.json")):
        start, _, recipe = path.stem.rpartition("_")
        if path.stem in known or (recipe.isdecimal() and start in known):
            yield place, path.stem
