"""Procedure 103: the arm turns one axis at a time, and the solver finds the base."""

from dataclasses import replace
from datetime import timedelta

import numpy as np
import pytest

from cellctl.calibration.solvers.base_frame.base_frame import BaseFrameResult
from cellctl.calibration.store.envelope import read_calibration, write_stored
from cellctl.errors.calibration import CalibrationInvalidated
from cellctl.errors.link import ReplyTimeout
from cellctl.errors.robot import ArmOffReference, ArmReferenceMissing
from cellctl.geometry.pose import pose_error
from cellctl.processes.deck_to_frame.calibrations import BASE_FRAME, BOARD_TRANSFER
from cellctl.records.entries import RunResult, Verdict
from cellctl.records.store import RunStore
from cellctl.runtime.invalidation import invalidate_after
from cellctl.runtime.steps import HeldMeanwhile
from tests.rigs.calibration.turned_arm import C_T_BASE
from tests.rigs.sweeps import sweep
from tests.unit.procedures.large_field import Watching
from tests.unit.procedures.rig import ProcedureRig


@pytest.fixture
def watching(rig: ProcedureRig) -> Watching:
    return Watching(rig)


async def test_the_base_is_found_and_the_arm_goes_home(
    rig: ProcedureRig, watching: Watching
) -> None:
    outcome = await rig.run(103)
    settings, main = rig.bench.settings, rig.bench.deck.main_config
    assert (outcome.kind, outcome.serial_number, outcome.passed) == (BASE_FRAME, "ET-7", True)
    found = BaseFrameResult.from_record(outcome.record).c_T_base.pose
    distance, angle = pose_error(C_T_BASE, found)
    assert np.linalg.norm(distance) < 1e-3
    assert np.degrees(np.linalg.norm(angle)) < 0.05
    joints = np.degrees([move.target for move in rig.bench.cell.main.moves])
    start, stops = np.array(settings.base_frame_joints_deg), settings.circle_stops
    home, *turns, middle, home_again = joints
    assert len(turns) == 2 * (stops + 1)
    first, second = turns[1 : stops + 1] - start, turns[stops + 2 :] - start
    for between in (turns[0], turns[stops + 1], middle):
        np.testing.assert_allclose(between, start, atol=1e-9)
    half = settings.circle_arc_deg / 2
    np.testing.assert_allclose(first[:, 0], np.linspace(-half, half, stops), atol=1e-9)
    np.testing.assert_allclose(second[:, 1], np.linspace(-half, half, stops), atol=1e-9)
    np.testing.assert_allclose(np.delete(first, 0, axis=1), 0.0, atol=1e-9)
    np.testing.assert_allclose(np.delete(second, 1, axis=1), 0.0, atol=1e-9)
    for end in (home, home_again):
        np.testing.assert_allclose(end, main.poses_deg["home"], atol=1e-9)
    assert watching.frames == [settings.tracker_frames] * (2 * stops + 1)
    assert all(move.speed == main.speed_percent / 100 for move in rig.bench.cell.main.moves)


async def test_a_hold_on_the_way_spoils_the_circle(rig: ProcedureRig, watching: Watching) -> None:
    rig.pauses._held_at = (5,)
    with pytest.raises(HeldMeanwhile):
        await rig.run(103)
    assert len(watching.frames) == 4


async def test_a_silent_head_ends_it(rig: ProcedureRig) -> None:
    rig.bench.cell.tracker.silent = True
    with pytest.raises(ReplyTimeout):
        await rig.run(103)
    assert len(rig.bench.cell.main.moves) == 3, "home, middle of the arc, first stop"


async def measured(rig: ProcedureRig) -> None:
    """Procedure 103, with its result in the store."""
    outcome = await rig.run(103)
    rig.bench.calibrations.store(BASE_FRAME, outcome.record, "ET-7", timedelta(days=1), None)
    rig.bench.cell.main.moves.clear()


async def test_an_arm_that_nobody_has_touched_passes_its_check(
    rig: ProcedureRig, watching: Watching
) -> None:
    await measured(rig)
    assert await rig.procedures[109].run(rig.context) is None
    assert "all targets within 0." in rig.told[-1].message
    joints = np.degrees([move.target for move in rig.bench.cell.main.moves])
    settings, main = rig.bench.settings, rig.bench.deck.main_config
    np.testing.assert_allclose(joints[-2], settings.base_frame_joints_deg, atol=1e-9)
    np.testing.assert_allclose(joints[-1], main.poses_deg["home"], atol=1e-9)


@pytest.mark.parametrize("turned_deg", [0.0, 0.02])
async def test_a_check_leaves_in_its_run_how_far_each_target_is(
    rig: ProcedureRig, watching: Watching, turned_deg: float
) -> None:
    await measured(rig)
    watching.mastered_beside_rad[0] = np.radians(turned_deg)
    job = rig.job(109)
    await job.start()
    try:
        await job.execute()
        await job.close(RunResult.GOOD, None)
    except ArmOffReference as fault:
        await job.close(RunResult.ABORTED, fault)
    record = await rig.archive.do(RunStore.run, job.run_number)
    found = record.newest_figures
    assert len(found) == 6
    assert all(key.startswith("target_offset.") for key in found)
    moved = any(one.verdict is Verdict.FAIL for one in found.values())
    assert moved == (record.head.result == RunResult.ABORTED) == (turned_deg > 0)


@pytest.mark.parametrize("joint", sweep(range(1, 7), (1, 4)))
async def test_a_joint_that_was_mastered_anew_is_found_and_costs_what_rests_on_the_arm(
    rig: ProcedureRig, watching: Watching, joint: int
) -> None:
    await measured(rig)
    # A joint near the flange has a short lever: the ring of targets is all that shows its turn.
    watching.mastered_beside_rad[joint - 1] = np.radians(0.02 if joint < 4 else 0.3)
    with pytest.raises(ArmOffReference) as caught:
        await rig.procedures[109].run(rig.context)
    assert rig.bench.cell.main.moves, "the arm is home before anybody is told"
    home = rig.bench.deck.main_config.poses_deg["home"]
    np.testing.assert_allclose(np.degrees(rig.bench.cell.main.joints_rad), home, atol=1e-9)
    await invalidate_after(caught.value, rig.bench.calibrations, rig.archive)
    with pytest.raises(CalibrationInvalidated, match="F319"):
        rig.bench.calibrations.read(BASE_FRAME)
    with pytest.raises(CalibrationInvalidated, match="F319"):
        rig.bench.calibrations.read(BOARD_TRANSFER)


async def test_a_base_frame_without_a_reference_cannot_be_checked(
    rig: ProcedureRig, watching: Watching
) -> None:
    """An older version has stored it so; nothing is measured or voided then."""
    folder = rig.bench.calibrations.path
    stored = read_calibration(folder, BASE_FRAME.name)
    record = {key: value for key, value in stored.record.items() if key != "reference"}
    write_stored(folder, replace(stored, record=record))
    with pytest.raises(ArmReferenceMissing, match="without one"):
        await rig.procedures[109].run(rig.context)
    assert not watching.frames
    assert rig.bench.calibrations.read(BASE_FRAME).reference is None
