"""Validity for displays: cheap, at once after a change of one's own, soon after another's."""

from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.calibration.store import validity
from cellctl.calibration.store.envelope import read_stored
from cellctl.calibration.store.marker import mark_invalid
from cellctl.calibration.store.store import CalibrationStore
from cellctl.calibration.store.validity import ValidityClock
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS, PAYLOAD
from tests.unit.calibration.store.shipped import renew_calibrations

LOOK_S = 0.5


@dataclass
class Hand:
    """A clock that goes on when the test says so."""

    time_s: float = 0.0

    def __call__(self) -> float:
        return self.time_s


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    renew_calibrations(tmp_path)
    return tmp_path


def test_the_files_are_looked_at_now_and_then(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[Path] = []

    def changed(path: Path) -> tuple[int, int]:
        looked.append(path)
        return 0, 0

    monkeypatch.setattr(validity, "_changed", changed)
    clock = Hand()
    valid = ValidityClock(folder, utc_now, LOOK_S, clock)
    for _ in range(20):
        assert valid.hours(PAYLOAD) > 0.0
        assert valid.marked() == []
    assert len(looked) == 2, "the record and its marker, once"
    clock.time_s = LOOK_S
    valid.hours(PAYLOAD)
    assert len(looked) == 4


def test_what_another_program_marks_is_seen_after_a_while(folder: Path) -> None:
    clock = Hand()
    valid = ValidityClock(folder, utc_now, LOOK_S, clock)
    assert valid.hours(PAYLOAD) > 0.0
    assert valid.marked() == []
    mark_invalid(folder, PAYLOAD.name, "a collision", utc_now())
    clock.time_s = LOOK_S
    assert valid.hours(PAYLOAD) == 0.0
    assert valid.marked() == [PAYLOAD.name]


def test_what_the_store_changes_itself_is_seen_at_once(folder: Path) -> None:
    store = CalibrationStore(folder, CALIBRATIONS)
    store.look_every(3600.0)
    assert store.all_valid(CALIBRATIONS)
    store.invalidate([PAYLOAD], "a collision")
    assert not store.all_valid(CALIBRATIONS)
    assert store.validity_h([PAYLOAD]) == {"payload": 0.0}
    record = read_stored(folder, PAYLOAD.name).record
    store.store(PAYLOAD, record, "FS-1", timedelta(hours=1))
    assert store.validity_h([PAYLOAD])["payload"] > 0.0
