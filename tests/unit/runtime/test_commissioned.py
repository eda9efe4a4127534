"""Commissioned figures count while their records are there, passed, valid and of the recipe."""

from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest

from cellctl.calibration.files import StoredCalibration, write_stored
from cellctl.calibration.invalidation import mark_invalid
from cellctl.clock import utc_now
from cellctl.runtime.commissioned import Commissioned, read_commissioned
from tests.unit.cell.bench import spoil

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


def read(folder: Path, recipe_id: int = 1) -> Commissioned:
    return read_commissioned(folder, recipe_id, utc_now(), HOUR)


def test_nothing_commissioned(tmp_path: Path) -> None:
    assert read(tmp_path) == Commissioned()


def test_both_figures_with_where_they_come_from(tmp_path: Path) -> None:
    latency, stiffness = store_both(tmp_path)
    found = read(tmp_path)
    assert found.stop_latency_s == pytest.approx(0.262)
    assert found.stiffness_n_m == pytest.approx(6.1e5)
    assert found.ids == {"stop_latency": latency.id, "contact_stiffness_1": stiffness.id}


def test_the_stiffness_of_another_recipe_says_nothing(tmp_path: Path) -> None:
    store_both(tmp_path)
    found = read(tmp_path, recipe_id=2)
    assert found.stiffness_n_m is None
    assert found.stop_latency_s is not None
    assert list(found.ids) == ["stop_latency"]


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
    assert read_commissioned(tmp_path, 1, before, HOUR).stiffness_n_m is None
