"""Guarded moves before the real monitor, in a guard that nobody has told what hangs on it."""

from contextlib import nullcontext
from types import SimpleNamespace
from typing import cast

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.guard.client import GuardClient
from cellctl.interfaces import Robot
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE

UP_M = 5e-3


@pytest.mark.parametrize("restarted", [True, False])
def test_the_first_move_after_a_restart_may_be_one_out_of_a_station(restarted: bool) -> None:
    world = MatingCell.drawn(5, stiffness_n_m=1e6, stop_latency_s=0.05)
    if restarted:
        world.guard.begin_anew()
        # Until a pose and a sample have come in, which takes the real guard as long to open.
        world.advance(world.start_s + 0.1)
    config = shipped_cell(CELL_FILE.name)
    arm = GuardedRobot(
        cast(Robot, world.robot), config.robots["main"], "force",
        cast(GuardClient, world.guard), config.force_sensors["force"],
    )  # fmt: skip
    cell = cast(Cell, SimpleNamespace(trips_awaited=lambda _: nullcontext()))
    begun = world.arm.encoder_pose(world.start_s)
    up = RigidTransform.from_translation([0.0, 0.0, UP_M]) * begun

    async def rise() -> None:
        tolerance = WrenchTolerance(60.0, 30.0)
        async with guarded_moves(cell, arm, RigidTransform.identity(), tolerance) as move:
            await move(world.robot.move_linear(up, speed_m_s=0.01, acceleration_m_s2=0.05))

    run_simulated(world.start_s, world.advance, rise)
    there = world.arm.encoder_pose(world.world.time_s)
    assert there.translation[2] - begun.translation[2] == pytest.approx(UP_M, abs=2e-4)
    # What was identified is not given up for a tare.
    assert world.guard.gravity_compensated is not restarted
