"""What procedure 301 has measured counts in place of the bounds, while it is there and valid."""

import asyncio
from datetime import timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.calibration.checks import all_passed
from cellctl.calibration.store.envelope import StoredCalibration, write_stored
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.contact_motion.commissioning import CommissionedLoop, StepAnswer
from cellctl.clock import utc_now
from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.force.contact.streamed.identification import StiffnessFit
from cellctl.processes.peg_in_hole.calibrations import CALIBRATIONS, CONTACT_LOOP
from cellctl.processes.peg_in_hole.facts import read_facts
from cellctl.processes.peg_in_hole.procedures.contact_loop_picture import loop_picture
from cellctl.processes.peg_in_hole.procedures.procedure_list import peg_procedures
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.record.loop_record import (
    figures_of_record,
    loop_checks,
    loop_record,
)
from cellctl.processes.peg_in_hole.run import PegFacts
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import PegCell
from tests.rigs.shipped import shipped_cell

CELL = shipped_cell("insertion-pin.toml")
SETTINGS = cast(PegSettings, CELL.processes["peg-in-hole"])
RECIPE = cast(PegRecipe, CELL.recipes[0])
PEG_CELL = PegCell(None, None, SETTINGS)  # type: ignore[arg-type]  # figures alone


def found(stiffness_n_m: float = 1.0e5, dead_time_s: float = 0.03) -> CommissionedLoop:
    force_n = np.array([5.0, 10.0, 15.0, 20.0])
    return CommissionedLoop(
        figures=LoopFigures(stiffness_n_m, dead_time_s),
        usual_dead_time_s=0.9 * dead_time_s,
        motion_dead_time_s=0.4 * dead_time_s,
        stiffness=StiffnessFit(stiffness_n_m, 0.01 * stiffness_n_m, 2e-6),
        fitted=LoopFigures(stiffness_n_m, dead_time_s),
        readings=np.stack([force_n / stiffness_n_m, force_n], axis=1),
        answer=StepAnswer(np.array([0.0, 0.05]), np.array([0.0, 4.0]), 4.0),
    )


def record(**changes: Any) -> dict[str, Any]:
    result = found()
    return loop_record(result, loop_checks(result, SETTINGS), 1, 7) | changes


def facts(folder: Path) -> tuple[PegFacts, int]:
    store = CalibrationStore(folder, CALIBRATIONS)
    prepared = asyncio.run(read_facts(PEG_CELL, RECIPE, store))
    return prepared.facts, len(prepared.stored)


def keep(folder: Path, *, hours: float = 24.0, **changes: Any) -> None:
    kind = CONTACT_LOOP.for_recipe(1).name
    until = utc_now() + timedelta(hours=hours)
    write_stored(folder, StoredCalibration(kind, record(**changes), utc_now(), until, "test", ""))


def test_without_a_measurement_the_bounds_count(tmp_path: Path) -> None:
    plain, used = facts(tmp_path)
    assert used == 0
    assert plain.contact.figures.stiffness_n_m == pytest.approx(1.2e5)
    assert plain.contact.figures.dead_time_s == pytest.approx(0.06)


def test_a_measured_loop_counts_with_its_uncertainty_and_touches_faster(tmp_path: Path) -> None:
    bounds, _ = facts(tmp_path)
    keep(tmp_path)
    measured, used = facts(tmp_path)
    assert used == 1
    assert measured.contact.figures.stiffness_n_m == pytest.approx(1.02e5)
    assert measured.contact.figures.dead_time_s == pytest.approx(0.03)
    assert measured.contact.touch_speed_m_s > 1.4 * bounds.contact.touch_speed_m_s
    assert measured.plan.task.cell.dead_time_s == pytest.approx(0.03), "the search knows it too"


@pytest.mark.parametrize("change", [{"hours": 0.5}, {"verdict": "fail"}])
def test_what_is_not_valid_or_did_not_pass_is_left_alone(
    tmp_path: Path, change: dict[str, Any]
) -> None:
    keep(tmp_path, **change)
    assert facts(tmp_path)[0].contact.figures.dead_time_s == pytest.approx(0.06)


@pytest.mark.parametrize(
    ("stiffness_n_m", "dead_time_s", "fails"),
    [(1.0e5, 0.03, ""), (1.3e5, 0.03, "stiffness"), (1.0e5, 0.07, "dead time")],
)
def test_the_bounds_must_hold(stiffness_n_m: float, dead_time_s: float, fails: str) -> None:
    checks = loop_checks(found(stiffness_n_m, dead_time_s), SETTINGS)
    assert [check.name for check in checks if not check.passed] == ([fails] if fails else [])


@given(
    st.dictionaries(
        st.sampled_from(["stiffness_n_mm", "sigma_n_mm", "dead_time_ms"]),
        st.floats() | st.text(max_size=4) | st.none() | st.booleans() | st.lists(st.floats()),
    )
)
def test_any_record_is_read_or_refused(changes: dict[str, Any]) -> None:
    try:
        figures = CONTACT_LOOP.result(record(**changes))
    except CalibrationRecordInvalid:
        return
    assert 1e3 <= figures.stiffness_n_m <= 1e7
    assert 1e-3 <= figures.dead_time_s <= 0.2


def test_what_is_stored_comes_back() -> None:
    figures = figures_of_record(record())
    assert figures.dead_time_s == pytest.approx(found().figures.dead_time_s)


def test_the_picture_is_a_picture() -> None:
    checks = loop_checks(found(), SETTINGS)
    assert all_passed(checks)
    assert loop_picture(found(), checks).startswith(b"\x89PNG")


def test_each_recipe_has_its_procedure() -> None:
    other = RECIPE.model_copy(update={"id": 7})
    offered = peg_procedures(PEG_CELL, (RECIPE, other), cast(Any, SimpleNamespace()))
    assert [procedure.number for procedure in offered] == [
        *(301, 30_101, 30_107),
        *(302, 30_201, 30_207),
    ]
    assert all(procedure.contact for procedure in offered)
    assert [procedure.step for procedure in offered] == [301] * 3 + [302] * 3
