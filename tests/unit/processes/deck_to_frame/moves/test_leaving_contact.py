"""Off the frame with real contact, on simulated time: free, or held by a jammed dowel."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.errors.force import LiftOffHeld
from cellctl.force.contact.leaving import FIRST_LIFT_M
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.back_off import back_off
from cellctl.processes.deck_to_frame.mating.phases import settle_and_tare
from cellctl.processes.deck_to_frame.moves.lift_off import LIFT_M, lift_off
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated
from tests.rigs.mating.trial import nominal_settings, plan_for
from tests.rigs.sweeps import sweep
from tests.unit.processes.deck_to_frame.moves.test_guarded_moves import cell_of

LATENCY_S = 0.25
PRESSED_N = 44.0
"""Full mating force: the guard stops a mating at 45 N."""
PULL_N = 100.0
"""Twice the limit of the recipe."""

Leave = Callable[[Attempt, MatingCell], Awaitable[None]]


class Scene:
    """A deck that is pressed on its frame, zero taken at the stand-off, latches released."""

    def __init__(self, *, held: bool) -> None:
        self.world = MatingCell.drawn(3, stiffness_n_m=1e6, stop_latency_s=LATENCY_S)
        if held:
            self.world.world.faults.inject("held_dowel")
            self.world.world.rebuild()
        self.plan = plan_for(self.world, nominal_settings(LATENCY_S))
        self.left_at_m = 0.0
        self.pull_n = 0.0

    def run(self, leave: Leave) -> None:
        run_simulated(self.world.start_s, self._advance, lambda: self._run(leave))

    @property
    def moved_m(self) -> float:
        here = self.world.arm.encoder_pose(self.world.world.time_s)
        return self.left_at_m - self.plan.travel_of(here)

    def _advance(self, to_s: float) -> None:
        self.world.advance(to_s)
        self.pull_n = max(self.pull_n, -self.world.world.payload.suspension.normal_forces.sum())

    async def _run(self, leave: Leave) -> None:
        world, plan = self.world, self.plan
        async with ContactRecorder(world.robot, world.guard, plan.travel_of) as recorder:
            attempt = Attempt(world.robot, world.guard, plan, recorder, lambda _: None)
            await settle_and_tare(attempt)
            travel_m = plan.window.expected_m - 1e-4
            await world.robot.move_linear(
                plan.pose_at(travel_m), speed_m_s=0.01, acceleration_m_s2=0.2
            )
            while (missing_n := PRESSED_N - world.world.payload.contact_force_n) > 0.5:
                travel_m += missing_n / 1.2e6
                await world.robot.step(plan.pose_at(travel_m), speed_m_s=1e-3)
                await asyncio.sleep(0.1)
            self.left_at_m = travel_m
            await leave(attempt, world)


async def lift(_: Attempt, world: MatingCell) -> None:
    await lift_off(cell_of(world))


async def retreat(attempt: Attempt, _: MatingCell) -> None:
    await back_off(attempt)


@pytest.mark.parametrize(("leave", "way_m"), [(lift, LIFT_M), (retreat, 2e-3)])
@pytest.mark.long
def test_from_full_force_a_free_deck_comes_off_without_a_fault(leave: Leave, way_m: float) -> None:
    scene = Scene(held=False)
    scene.run(leave)
    assert scene.moved_m == pytest.approx(way_m, abs=2e-4)
    assert scene.world.guard.trip is None
    assert scene.world.world.payload.contact_force_n == 0.0


@pytest.mark.parametrize("leave", sweep((lift, retreat), (retreat,)))
def test_a_deck_that_is_held_is_a_fault_and_the_pull_is_bounded(leave: Leave) -> None:
    scene = Scene(held=True)
    with pytest.raises(LiftOffHeld):
        scene.run(leave)
    assert 10.0 < scene.pull_n < PULL_N
    assert scene.moved_m < FIRST_LIFT_M
    assert not scene.world.arm.moving(scene.world.world.time_s)
