"""Out of the hole in a new daemon, whose guard knows nothing, and what the force is told as."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.force import LiftOffHeld, NotSettled
from cellctl.errors.robot import MotionRejected
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import Robot
from cellctl.processes.peg_in_hole.leaving import CLEAR_OF_FACE_M, leave_hole, show_force_on_tip
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import OVER, PegCell, peg_recipes
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot

CELL = shipped_cell("insertion-pin.toml")


class NewGuard(TinyGuard):
    """Knows no load yet; remembers the one that it is given."""

    load: GravityCompensation | None = None

    def __init__(self) -> None:
        super().__init__(gravity_compensated=False, in_part_frame=False)
        self.moved_with: list[GravityCompensation | None] = []

    async def arm(self, limits: GuardLimits) -> None:
        await super().arm(limits)
        self.moved_with.append(self.load)

    async def set_gravity_compensation(self, compensation: object) -> None:
        assert not self.armed, "an armed guard refuses it"
        await super().set_gravity_compensation(compensation)
        assert isinstance(compensation, GravityCompensation)
        self.load = compensation


def flange_at(depth_mm: float, x_mm: float = 0.0) -> RigidTransform:
    """The flange with the tip so deep in the hole, or so deep beside it."""
    (recipe,) = peg_recipes(CELL)
    hole = pose_from_xyzabc(recipe.base_T_hole.pose)
    place = RigidTransform.from_components(np.array([x_mm, 0.0, -depth_mm]) * 1e-3, OVER)
    return hole * place * pose_from_xyzabc(recipe.flange_T_tip).inv()


def left_at(
    depth_mm: float,
    x_mm: float = 0.0,
    config: Any = CELL,
    *,
    stiffness_n_mm: float | None = None,
    zero_file: Path | None = None,
) -> tuple[PegCell, StillRobot, NewGuard]:
    guard = NewGuard()
    robot = StillRobot("arm", flange=flange_at(depth_mm, x_mm), watched_by=guard)
    (sensor,) = CELL.force_sensors
    arm = GuardedRobot(
        cast(Robot, robot), CELL.robots[CELL.force_sensors[sensor].mounted_on], sensor,
        cast(GuardClient, guard), CELL.force_sensors[sensor], zero_file,
    )  # fmt: skip
    cell: Any = SimpleNamespace(config=config, trips_awaited=lambda _: nullcontext())
    settings = CELL.processes["peg-in-hole"]
    if stiffness_n_mm is not None:
        settings = settings.model_copy(update={"stiffness_n_mm": stiffness_n_mm})
    return PegCell(cell, arm, cast(PegSettings, settings)), robot, guard


@pytest.mark.parametrize("armed", [False, True], ids=["restarted", "stopped"])
async def test_the_weight_is_known_before_the_arm_leaves_the_hole(armed: bool) -> None:
    cell, robot, guard = left_at(5.0)
    guard.armed = armed
    await leave_hole(cell)
    assert [move.kind for move in robot.moves] == ["linear", "linear", "joint"]
    risen_m = robot.moves[1].target.translation[2] - flange_at(5.0).translation[2]
    assert risen_m > CLEAR_OF_FACE_M + 5e-3
    (recipe,) = peg_recipes(CELL)
    for load in guard.moved_with:
        assert load is not None
        np.testing.assert_allclose(load.A[0, 0], recipe.load.mass_kg * 9.80665)


@pytest.mark.parametrize(
    ("in_frame", "tared", "pressed_n"),
    [(True, True, 25.0), (False, True, 30.0), (True, False, 30.0)],
    ids=["stopped", "after a free move", "guard started anew"],
)
async def test_the_press_that_a_stop_has_left_is_no_pull(
    in_frame: bool, tared: bool, pressed_n: float
) -> None:
    cell, _, guard = left_at(5.0)
    guard.in_part_frame, guard.hidden_axial_n = in_frame, 0.0 if tared else None
    guard.raw = guard.raw * 0.05 - np.array([0.0, 0.0, 25.0, 0.0, 0.0, 0.0])
    await leave_hole(cell)
    (recipe,) = peg_recipes(CELL)
    assert recipe.forces.insertion_n == 30.0
    x_n, y_n, z_n, *_ = guard.limits[0].filtered
    # As much as a run may press where nobody knows.
    assert z_n == pytest.approx(recipe.forces.withdrawal_n + pressed_n, abs=0.1)
    assert x_n == y_n == recipe.forces.withdrawal_n


async def test_a_second_reset_counts_what_the_zero_of_the_first_has_hidden() -> None:
    cell, robot, guard = left_at(5.0)
    guard.in_part_frame = True
    guard.raw = guard.raw * 0.05 - np.array([0.0, 0.0, 25.0, 0.0, 0.0, 0.0])
    robot.faults["move"] = MotionRejected("stopped")
    with pytest.raises(MotionRejected):
        await leave_hole(cell)
    # By the zero of the first one, 10 N of the press have gone.
    guard.raw = guard.raw + np.array([0.0, 0.0, 35.0, 0.0, 0.0, 0.0])
    del robot.faults["move"]
    await leave_hole(cell)
    (recipe,) = peg_recipes(CELL)
    _, second, *_ = guard.limits
    assert second.filtered[2] == pytest.approx(recipe.forces.withdrawal_n + 15.0, abs=0.1)


async def test_a_peg_that_holds_a_full_pull_is_not_pulled_again() -> None:
    cell, robot, guard = left_at(5.0)
    guard.in_part_frame = True
    guard.raw = guard.raw * 0.05 + np.array([0.0, 0.0, 21.0, 0.0, 0.0, 0.0])
    for _ in range(2):
        with pytest.raises(LiftOffHeld, match="pulled with 21 N already, allowed 20 N"):
            await leave_hole(cell)
    assert robot.moves == []


def feels(cell: PegCell, guard: NewGuard, along_z_n: float) -> None:
    """The true force along z of the tip, beside what the sensor reads of its load."""
    (recipe,) = peg_recipes(CELL)
    sensor_T_tip = cell.arm.flange_T_sensor.inv() * pose_from_xyzabc(recipe.flange_T_tip)
    force_n = sensor_T_tip.rotation.apply([0.0, 0.0, along_z_n]) + np.array([1.0, 2.0, -11.0])
    noise = np.random.default_rng(1).normal(0.0, 0.01, (200, 6))
    guard.raw = noise + np.concatenate([force_n, np.zeros(3)])


async def test_a_restart_does_not_forget_how_hard_the_peg_is_pulled(tmp_path: Path) -> None:
    (recipe,) = peg_recipes(CELL)
    pull_n, most_n = recipe.forces.withdrawal_n, recipe.forces.insertion_n
    zero_file = tmp_path / "force.json"
    cell, robot, guard = left_at(5.0, zero_file=zero_file)
    feels(cell, guard, -most_n)
    guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz 51.0 N, limit 50.00 N", 2, 51.0)
    with pytest.raises(LiftOffHeld):
        await leave_hole(cell)
    for _ in range(2):
        cell, robot, guard = left_at(5.0, zero_file=zero_file)
        feels(cell, guard, pull_n)
        with pytest.raises(LiftOffHeld, match=f"pulled with {pull_n:.0f} N already"):
            await leave_hole(cell)
        assert robot.moves == []
    # Somebody has freed it.
    cell, robot, guard = left_at(5.0, zero_file=zero_file)
    feels(cell, guard, 0.0)
    await leave_hole(cell)
    assert [move.kind for move in robot.moves] == ["linear", "linear", "joint"]
    assert guard.limits[0].filtered[2] == pytest.approx(pull_n, abs=0.1)
    assert not zero_file.exists()


async def test_a_daemon_that_is_killed_while_it_pulls_has_kept_what_it_knew(
    tmp_path: Path,
) -> None:
    (recipe,) = peg_recipes(CELL)
    zero_file = tmp_path / "force.json"
    cell, robot, guard = left_at(5.0, zero_file=zero_file)
    feels(cell, guard, -recipe.forces.insertion_n)
    robot.faults["move"] = MotionRejected("killed here")
    with pytest.raises(MotionRejected):
        await leave_hole(cell)
    cell, robot, guard = left_at(5.0, zero_file=zero_file)
    feels(cell, guard, 12.0)
    await leave_hole(cell)
    assert guard.limits[0].filtered[2] == pytest.approx(recipe.forces.withdrawal_n - 12.0, abs=0.1)


async def test_a_part_that_is_held_is_told_as_one_and_stays_where_it_is() -> None:
    cell, robot, guard = left_at(5.0)
    guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz 51.0 N, limit 50.00 N", 2, 51.0)
    with pytest.raises(LiftOffHeld, match=r"out of its hole: .*Fz 51\.0 N"):
        await leave_hole(cell)
    assert len(robot.moves) <= 1
    assert robot.latched
    assert guard.armed, "watched until somebody clears"


@pytest.mark.parametrize(
    ("stiffness_n_mm", "first_mm"), [(120.0, 0.833), (1000.0, 0.4), (1.0, None)]
)
async def test_the_first_stretch_is_slow_until_a_part_that_is_held_would_have_stopped_it(
    stiffness_n_mm: float, first_mm: float | None
) -> None:
    cell, robot, _ = left_at(5.0, stiffness_n_mm=stiffness_n_mm)
    await leave_hole(cell)
    *pulls, _ = robot.moves
    start_m = flange_at(5.0).translation[2]
    heights_mm = [(move.target.translation[2] - start_m) * 1e3 for move in pulls]
    assert pulls[0].speed == 1e-3
    if first_mm is None:
        assert len(pulls) == 1, "an arm so soft is slow all the way"
    else:
        assert heights_mm[0] == pytest.approx(first_mm, abs=1e-3)
        assert pulls[1].speed == 5e-3
        assert heights_mm[1] == pytest.approx(21.5, abs=1e-6)


async def test_a_load_that_swings_leaves_the_pull_known() -> None:
    cell, robot, guard = left_at(5.0)
    guard.gravity_compensated = guard.in_part_frame = True
    guard.raw, guard.hidden_axial_n = guard.raw * 0.05, 10.0
    guard.settling = replace(guard.settling, timeout_s=0.0)
    with pytest.raises(NotSettled):
        await leave_hole(cell)
    assert robot.moves == []
    assert guard.hidden_axial_n == 10.0, "pulled with 10 N already"


async def test_the_hole_of_another_arm_is_not_left() -> None:
    (recipe,) = peg_recipes(CELL)
    others = recipe.model_copy(update={"roles": {"force": "another_sensor"}})
    cell, robot, _ = left_at(5.0, config=SimpleNamespace(recipes=(others,)))
    await leave_hole(cell)
    assert [move.kind for move in robot.moves] == ["joint"]


async def test_the_force_on_a_tip_in_its_hole_is_told_in_its_axes_without_the_weight() -> None:
    cell, robot, guard = left_at(5.0)
    await show_force_on_tip(cell)
    assert guard.gravity_compensated
    (recipe,) = peg_recipes(CELL)
    in_the_run = cell.arm.flange_T_sensor.inv() * pose_from_xyzabc(recipe.flange_T_tip)
    assert guard.sensor_T_wrench is not None
    np.testing.assert_allclose(guard.sensor_T_wrench.as_matrix(), in_the_run.as_matrix())
    # A tare would hide the very contact that is asked for.
    assert "tare" not in guard.asked
    assert robot.moves == []


async def test_from_a_touch_on_a_wide_circle_the_arm_leaves_straight_as_well() -> None:
    (recipe,) = peg_recipes(CELL)
    place = recipe.base_T_hole.model_copy(update={"face_radius_mm": 70.0})
    wide = recipe.model_copy(update={"base_T_hole": place})
    cell, robot, _ = left_at(0.0, x_mm=70.0, config=SimpleNamespace(recipes=(wide,)))
    await leave_hole(cell)
    assert [move.kind for move in robot.moves] == ["linear", "linear", "joint"]


async def test_away_from_the_hole_the_weight_is_known_and_the_axes_are_the_sensors() -> None:
    cell, _, guard = left_at(-100.0)
    await show_force_on_tip(cell)
    assert guard.gravity_compensated
    assert not guard.in_part_frame
