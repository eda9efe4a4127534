"""The record of a stored calibration, for checks that also work where there is none."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cellctl.calibration.store.envelope import read_calibration
from cellctl.errors import CellError


def readable_record(folder: Path, kind: str) -> Mapping[str, Any] | None:
    """The record of a calibration that nothing has invalidated; None where none can be read."""
    try:
        return read_calibration(folder, kind).record
    except CellError:
        return None  # a new cell has none; the daemon names one that is damaged
