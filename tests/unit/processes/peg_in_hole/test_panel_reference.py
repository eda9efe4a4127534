"""A face that is met elsewhere than before, and what a run may do once its reference is void."""

import asyncio
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.checks import evidence_to_record
from cellctl.calibration.store.store import CalibrationStore
from cellctl.errors.calibration import CalibrationExpired, CalibrationInvalidated
from cellctl.processes.peg_in_hole.calibrations import CALIBRATIONS, PANEL_REFERENCE
from cellctl.processes.peg_in_hole.facts import read_facts
from cellctl.processes.peg_in_hole.faults import PanelOffReference
from cellctl.processes.peg_in_hole.panel_reference import PanelReference, require_panel_at_reference
from tests.unit.processes.peg_in_hole.test_measured_loop import PEG_CELL, RECIPE

FACE = RigidTransform.from_components([0.8, 0.1, 0.4], Rotation.from_euler("x", 170.0, True))
MOST_MM, MOST_DEG = 0.3, 0.5


def met(along_mm: float = 0.0, across_mm: float = 0.0, turned_deg: float = 0.0) -> RigidTransform:
    """The face moved in its own frame, whose z goes into the panel."""
    turn = Rotation.from_euler("y", turned_deg, degrees=True)
    shift_m = np.array([across_mm, 0.0, along_mm]) / 1000
    return FACE * RigidTransform.from_components(shift_m, turn)


@pytest.mark.parametrize(
    "now", [met(), met(along_mm=0.29), met(across_mm=50.0), met(turned_deg=0.49)]
)
def test_the_same_plane_passes(now: RigidTransform) -> None:
    require_panel_at_reference(PanelReference.of(FACE).checks(now, MOST_MM, MOST_DEG))


@pytest.mark.parametrize(
    ("now", "said"),
    [
        (met(along_mm=0.31), "beside its reference 0.31 mm"),
        (met(along_mm=-0.31), "beside its reference 0.31 mm"),
        (met(turned_deg=0.51), "turned from its reference 0.51"),
        (met(turned_deg=180.0), "turned from its reference 180"),
    ],
)
def test_another_one_is_a_fault(now: RigidTransform, said: str) -> None:
    with pytest.raises(PanelOffReference, match=said):
        require_panel_at_reference(PanelReference.of(FACE).checks(now, MOST_MM, MOST_DEG))


def test_a_record_comes_back_as_it_was() -> None:
    back = PanelReference.from_record(PanelReference.of(met(along_mm=1.0)).to_record())
    beside, turned = back.checks(met(along_mm=1.0), MOST_MM, MOST_DEG)
    assert beside.value == pytest.approx(0.0, abs=1e-9)
    assert turned.value == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(
    "changes",
    [{"base_normal": [0.0, 0.0, 0.9]}, {"base_normal": [1.0, 0.0]}, {"base_r_point_mm": [1, 2]}],
)
def test_what_is_no_plane_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="normal"):
        PanelReference.from_record(PanelReference.of(FACE).to_record() | changes)


def taken(folder: Path, hours: float = 24.0 * 30) -> CalibrationStore:
    store = CalibrationStore(folder, CALIBRATIONS)
    record = {**evidence_to_record("touches", ()), **PanelReference.of(FACE).to_record()}
    store.store(PANEL_REFERENCE.for_recipe(1), record, "", timedelta(hours=hours))
    return store


def test_a_run_compares_with_a_reference_that_was_taken(tmp_path: Path) -> None:
    store = CalibrationStore(tmp_path, CALIBRATIONS)
    assert asyncio.run(read_facts(PEG_CELL, RECIPE, store)).facts.panel is None
    facts = asyncio.run(read_facts(PEG_CELL, RECIPE, taken(tmp_path))).facts
    assert facts.panel is not None


def test_without_a_valid_one_no_run_begins_until_it_is_taken_anew(tmp_path: Path) -> None:
    store = taken(tmp_path)
    void = [kind for kind in CALIBRATIONS if PanelOffReference in kind.invalidated_by]
    assert {kind.name for kind in void} == {"panel_reference", "contact_loop"}
    store.invalidate(void, "F337")
    with pytest.raises(CalibrationInvalidated):
        asyncio.run(read_facts(PEG_CELL, RECIPE, store))
    asyncio.run(read_facts(PEG_CELL, RECIPE, taken(tmp_path)))


def test_an_expired_one_is_no_reference(tmp_path: Path) -> None:
    with pytest.raises(CalibrationExpired):
        asyncio.run(read_facts(PEG_CELL, RECIPE, taken(tmp_path, hours=0.0)))
