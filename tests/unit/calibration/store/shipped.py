"""The calibrations that ship with the fake cell, put into a folder of a test's own."""

import json
from collections.abc import Mapping
from datetime import timedelta
from functools import cache, lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cellctl.calibration.store.envelope import StoredCalibration, read_calibration, write_stored
from cellctl.clock import now_s, utc_now
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS

CELL_FILE = Path(__file__).parents[4] / "config" / "deck.toml"
SHIPPED = CELL_FILE.parent / "demo-calibration"
REQUIRED = [kind for kind in CALIBRATIONS if kind.required]
SERIALS = {"head_1": "FH-0001", "head_2": "FH-0002", "payload": "M4347K-1"}
"""Serial numbers of the instruments of the cell in memory."""


_A_DAY = timedelta(days=1)
_RENEWED_S = 600.0


def renew_calibrations(folder: Path, valid_for: timedelta = _A_DAY) -> None:
    """All that production requires, with the cell's instruments and a validity of their own."""
    if valid_for != _A_DAY:
        _write_all(folder, valid_for)
        return
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in _valid_for_a_day(int(now_s() // _RENEWED_S)).items():
        (folder / name).write_bytes(content)


@lru_cache(maxsize=1)
def _valid_for_a_day(_: int) -> Mapping[str, bytes]:
    """Files by their names, at most ten minutes old."""
    # A thousand tests want them, and to put each into words anew takes longer than most of them.
    with TemporaryDirectory() as folder:
        _write_all(Path(folder), _A_DAY)
        return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def _write_all(folder: Path, valid_for: timedelta) -> None:
    for kind in REQUIRED:
        record = _shipped_record(kind.name)
        now = utc_now()
        serial = SERIALS.get(kind.name, "ET-0001")
        stored = StoredCalibration(kind.name, record, now, now + valid_for, "test", serial)
        write_stored(folder, stored)


@cache
def _shipped_record(kind: str) -> Mapping[str, Any]:
    return read_calibration(SHIPPED, kind).record


def spoil(path: Path, **changes: Any) -> None:
    """Change keys of a JSON file."""
    data = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(data | changes), encoding="utf-8")
