"""Commissioned figures count while their records are there, passed, valid and of the recipe."""

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from cellctl.calibration.store.envelope import StoredCalibration, write_stored
from cellctl.calibration.store.marker import mark_invalid
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import (
    CALIBRATIONS,
    CONTACT_STIFFNESS,
    STOP_LATENCY,
)
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from tests.unit.calibration.store.shipped import spoil

HOUR = timedelta(hours=1)


def store(folder: Path, kind: str, *, hours: float = 24.0, **record: Any) -> StoredCalibration:
    now = utc_now()
    until = now + timedelta(hours=hours)
    stored = StoredCalibration(kind, {"verdict": "pass", **record}, now, until, "cellctl", "")
    write_stored(folder, stored)
    return stored


def store_both(folder: Path, **stiffness: Any) -> tuple[StoredCalibration, StoredCalibration]:
    values = {"upper_n_per_mm": 610.0, "recipe_id": 1} | stiffness
    latency = store(folder, "stop_latency", upper_ms=262.0)
    return latency, store(folder, "contact_stiffness_1", **values)


def snapshot(
    folder: Path, recipe_id: int = 1, now: Callable[[], datetime] = utc_now
) -> CalibrationSnapshot:
    kinds = (STOP_LATENCY, CONTACT_STIFFNESS.for_recipe(recipe_id))
    return CalibrationStore(folder, CALIBRATIONS, now).read_all(kinds, now() + HOUR)


def read(folder: Path, recipe_id: int = 1) -> Commissioned:
    return Commissioned.of(snapshot(folder, recipe_id), recipe_id)


def test_nothing_commissioned(tmp_path: Path) -> None:
    assert read(tmp_path) == Commissioned()


def test_both_figures_with_where_they_come_from(tmp_path: Path) -> None:
    latency, stiffness = store_both(tmp_path)
    found = read(tmp_path)
    assert found.stop_latency_s == pytest.approx(0.262)
    assert found.stiffness_n_m == pytest.approx(6.1e5)
    assert snapshot(tmp_path).ids == {
        "stop_latency": latency.id,
        "contact_stiffness_1": stiffness.id,
    }


def test_the_stiffness_of_another_recipe_says_nothing(tmp_path: Path) -> None:
    store_both(tmp_path)
    found = read(tmp_path, recipe_id=2)
    assert found.stiffness_n_m is None
    assert found.stop_latency_s is not None
    assert list(snapshot(tmp_path, recipe_id=2).ids) == ["stop_latency"]


@pytest.mark.parametrize("change", [{"hours": 0.5}, {"verdict": "fail"}])
def test_what_is_not_valid_or_did_not_pass_is_left_alone(
    tmp_path: Path, change: dict[str, Any]
) -> None:
    store_both(tmp_path, **change)
    assert read(tmp_path).stiffness_n_m is None


def test_a_changed_record_is_left_alone(tmp_path: Path) -> None:
    store_both(tmp_path)
    spoil(tmp_path / "stop_latency.json", record={"verdict": "pass", "upper_ms": 1.0})
    found = read(tmp_path)
    assert found.stop_latency_s is None
    assert found.stiffness_n_m is not None


def test_each_recipe_has_its_own_stiffness(tmp_path: Path) -> None:
    store_both(tmp_path)
    store(tmp_path, "contact_stiffness_2", upper_n_per_mm=300.0, recipe_id=2)
    assert read(tmp_path).stiffness_n_m == pytest.approx(6.1e5)
    assert read(tmp_path, recipe_id=2).stiffness_n_m == pytest.approx(3.0e5)


def test_what_is_invalidated_or_from_the_future_is_left_alone(tmp_path: Path) -> None:
    store_both(tmp_path)
    mark_invalid(tmp_path, "stop_latency", "the drive was exchanged", utc_now())
    found = read(tmp_path)
    assert found.stop_latency_s is None
    assert found.stiffness_n_m is not None
    before = utc_now() - timedelta(days=1)
    assert snapshot(tmp_path, now=lambda: before).ids == {}


def test_a_record_without_its_figure_is_left_alone(tmp_path: Path) -> None:
    store(tmp_path, "stop_latency", sigma_ms=4.0)
    assert read(tmp_path) == Commissioned()
