"""The calibrations that ship with the fake cell, put into a folder of a test's own."""

import json
from collections.abc import Mapping
from datetime import timedelta
from functools import cache
from pathlib import Path
from typing import Any

from cellctl.calibration.store.envelope import StoredCalibration, read_calibration, write_stored
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS

CELL_FILE = Path(__file__).parents[4] / "config" / "deck.toml"
SHIPPED = CELL_FILE.parent / "demo-calibration"
REQUIRED = [kind for kind in CALIBRATIONS if kind.required]
SERIALS = {"head_1": "FH-0001", "head_2": "FH-0002", "payload": "M4347K-1"}
"""Serial numbers of the instruments of the cell in memory."""


def renew_calibrations(folder: Path, valid_for: timedelta = timedelta(days=1)) -> None:
    """All that production requires, with the cell's instruments and a validity of their own."""
    for kind in REQUIRED:
        record = _shipped_record(kind.name)
        now = utc_now()
        serial = SERIALS.get(kind.name, "ET-0001")
        stored = StoredCalibration(kind.name, record, now, now + valid_for, "test", serial)
        write_stored(folder, stored)


@cache
def _shipped_record(kind: str) -> Mapping[str, Any]:
    # Hundreds of tests write it with other dates; nobody changes what was read.
    return read_calibration(SHIPPED, kind).record


def spoil(path: Path, **changes: Any) -> None:
    """Change keys of a JSON file."""
    data = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(data | changes), encoding="utf-8")
