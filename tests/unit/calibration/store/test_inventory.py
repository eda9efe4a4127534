"""What operators are shown of the folder of calibrations."""

from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.calibration.store.inventory import inventory
from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS, CONTACT_STIFFNESS
from tests.unit.calibration.store.shipped import renew_calibrations


@pytest.fixture
def store(tmp_path: Path) -> CalibrationStore:
    renew_calibrations(tmp_path)
    return CalibrationStore(tmp_path, CALIBRATIONS)


def problems(store: CalibrationStore) -> dict[str, str]:
    return {one.name: one.problem for one in inventory(store, utc_now()) if one.problem}


def test_nothing_is_wrong_with_what_was_made(store: CalibrationStore) -> None:
    assert len(inventory(store, utc_now())) == len(store.names())
    assert problems(store) == {}


def test_a_marker_whose_calibration_was_moved_away_is_shown(store: CalibrationStore) -> None:
    stiffness = CONTACT_STIFFNESS.for_recipe(1)
    store.store(stiffness, {"verdict": "pass"}, "", timedelta(days=1))
    store.invalidate([CONTACT_STIFFNESS], "fingers exchanged")
    shown = problems(store)
    assert list(shown) == [stiffness.name]
    (store.path / f"{stiffness.name}.json").unlink()
    assert store.fault([stiffness], timedelta(0)) is not None
    assert problems(store) == shown
    assert shown[stiffness.name].startswith("F635")
    assert "fingers exchanged" in shown[stiffness.name]
