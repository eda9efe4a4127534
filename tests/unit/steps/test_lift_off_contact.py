"""Lifting a seated deck on simulated time: contact goes, nothing holds, no false alarm."""

from types import SimpleNamespace
from typing import cast

import numpy as np

from benchmarks.campaign_mating_cell import MatingCell
from benchmarks.campaign_mating_loop import run_simulated
from benchmarks.campaign_mating_trial import nominal_settings, plan_for
from cellctl.cell.devices import Cell
from cellctl.config import load_cell
from cellctl.steps.lift_off import LIFT_M, lift_off
from cellctl.steps.mate import mate
from tests.unit.cell.bench import CELL_FILE


def test_a_deck_that_was_just_seated_comes_off_without_a_fault() -> None:
    world = MatingCell(7, stiffness_n_m=1e6, stop_latency_s=0.05)
    plan = plan_for(world, nominal_settings(0.05))
    cell = SimpleNamespace(
        main=world.robot,
        guard=world.guard,
        config=load_cell(CELL_FILE),
        base_T_frame=None,
        awaits_trips=False,
    )
    seated_n: list[float] = []

    async def mate_and_lift() -> None:
        await mate(world.robot, world.guard, plan, lambda _: None)
        seated_n.append(world.world.payload.contact_force_n)
        await lift_off(cast(Cell, cell))

    seat_m = plan.window.expected_m
    run_simulated(world.start_s, world.advance, mate_and_lift)
    assert seated_n[0] > 10.0
    assert world.world.payload.contact_force_n == 0.0
    travel_m = plan.travel_of(world.arm.encoder_pose(world.world.time_s))
    np.testing.assert_allclose(seat_m - travel_m, LIFT_M, atol=2e-4)
    assert world.guard.trip is None
