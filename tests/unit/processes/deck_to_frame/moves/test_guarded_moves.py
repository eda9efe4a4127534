"""Guarded moves on simulated time, with the swing of the load and real contact: no false alarm."""

from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.free_moves import move_joint_free
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.force import ForceLimitExceeded
from cellctl.guard.client import GuardClient
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.mating.mate import mate
from cellctl.processes.deck_to_frame.moves.lift_off import LIFT_M, lift_off
from cellctl.processes.deck_to_frame.record.deck_recorder import DeckRecorder
from cellctl.processes.deck_to_frame.run import AssemblyRun, OpenRun
from cellctl.processes.deck_to_frame.run_facts import RunFacts
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.processes.deck_to_frame.stations import DeckCell, FrameMemory, deck_recipes
from cellctl.runtime.interruption import Interruption
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated
from tests.rigs.mating.trial import nominal_settings, plan_for
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE

LATENCY_S = 0.05


def cell_of(world: MatingCell) -> DeckCell:
    """A cell without heads and tracker, because nothing here looks."""
    config = shipped_cell(CELL_FILE.name)
    cell = cast(Cell, SimpleNamespace(config=config, trips_awaited=lambda _: nullcontext()))
    robot, guard = cast(Robot, world.robot), cast(GuardClient, world.guard)
    arm = GuardedRobot(robot, config.robots["main"], "force", guard, config.force_sensors["force"])
    nothing: Any = None
    settings = cast(DeckSettings, config.processes["deck-to-frame"])
    recipes = deck_recipes(config)
    return DeckCell(cell, arm, nothing, nothing, nothing, settings, recipes, FrameMemory())


@dataclass
class Arrivals:
    """Stands in for the recorder: keeps where moves were sent, and where they ended."""

    seen: list[tuple[RigidTransform, RigidTransform]] = field(default_factory=list)

    async def arrived(self, commanded: RigidTransform, reported: RigidTransform) -> None:
        self.seen.append((commanded, reported))


def run_on(world: MatingCell, arrivals: Arrivals | None = None) -> AssemblyRun:
    cell, nothing = cell_of(world), cast(Any, None)
    values = dict.fromkeys(RunFacts.__dataclass_fields__, nothing)
    payload = SimpleNamespace(mass_kg=200.0)
    facts = RunFacts(**values | {"cell": cell, "recipe": cell.recipes[0], "payload": payload})
    recorder = cast(DeckRecorder, arrivals or Arrivals())
    return AssemblyRun(OpenRun(facts, nothing, recorder, nothing, Interruption(), nothing), nothing)


def raised(world: MatingCell, height_m: float) -> RigidTransform:
    up = RigidTransform.from_translation([0.0, 0.0, height_m])
    return up * world.arm.encoder_pose(world.world.time_s)


# A whole mating comes before. `test_leaving_contact.py` lifts a deck off without one.
@pytest.mark.long
def test_a_deck_that_was_just_seated_comes_off_without_a_fault() -> None:
    world = MatingCell.drawn(7, stiffness_n_m=1e6, stop_latency_s=LATENCY_S)
    plan = plan_for(world, nominal_settings(LATENCY_S))
    seated_n: list[float] = []

    async def mate_and_lift() -> None:
        await mate(world.robot, world.guard, plan, lambda _: None)
        seated_n.append(world.world.payload.contact_force_n)
        await lift_off(cell_of(world))

    run_simulated(world.start_s, world.advance, mate_and_lift)
    assert seated_n[0] > 10.0
    assert world.world.payload.contact_force_n == 0.0
    travel_m = plan.travel_of(world.arm.encoder_pose(world.world.time_s))
    np.testing.assert_allclose(plan.window.expected_m - travel_m, LIFT_M, atol=2e-4)
    assert world.guard.trip is None


@pytest.mark.figures  # seconds of motion
def test_free_moves_at_full_speed_stay_within_their_limits() -> None:
    world = MatingCell.drawn(8, stiffness_n_m=1e6, stop_latency_s=LATENCY_S)
    arrivals = Arrivals()
    run, above = run_on(world, arrivals), raised(world, 0.04)

    async def up_and_down() -> None:
        await run.move_flange(above, world.flange_T_deck)
        lower = RigidTransform.from_translation([0, 0, -0.015]) * above
        await run.move_near_frame(lower, world.flange_T_deck)

    run_simulated(world.start_s, world.advance, up_and_down)
    assert world.guard.trip is None
    moved = world.arm.encoder_pose(world.world.time_s).translation - above.translation
    assert len(arrivals.seen) == 2, "each move is recorded"
    for sent, reached in arrivals.seen:
        np.testing.assert_allclose(reached.translation, sent.translation, atol=1e-5)
    np.testing.assert_allclose(moved, [0, 0, -0.015], atol=1e-5)


def test_a_small_turn_does_not_swing_the_deck_that_hangs_below() -> None:
    # 0.01 degrees take the deck 0.09 mm aside, and the flange nowhere.
    world = MatingCell.drawn(8, stiffness_n_m=1e6, stop_latency_s=LATENCY_S)
    run, above = run_on(world), raised(world, 0.001)
    turn = RigidTransform.from_components(
        [1e-5, 0.0, 0.0], Rotation.from_rotvec([np.radians(0.01), 0.0, 0.0])
    )
    felt_n: list[float] = []

    def advance(to_s: float) -> None:
        world.advance(to_s)
        felt_n.append(float(world.world.sensor_wrench("force", world.world.time_s)[1]))

    async def up_and_turn() -> None:
        await run.move_near_frame(above, world.flange_T_deck)
        felt_n.clear()
        await run.move_near_frame(above * turn, world.flange_T_deck)

    run_simulated(world.start_s, advance, up_and_turn)
    swing_n = np.abs(np.array(felt_n) - felt_n[0]).max()
    assert swing_n < 12.0, "28 N with the acceleration of the recipe, where 28.2 N are the limit"


def test_a_frame_that_stands_too_high_stops_the_way_down() -> None:
    world = MatingCell.drawn(9, stiffness_n_m=1e5, stop_latency_s=LATENCY_S)
    run, below = run_on(world), raised(world, -0.013)

    async def down() -> None:
        await run.move_near_frame(below, world.flange_T_deck)

    with pytest.raises(ForceLimitExceeded, match="Fz"):
        run_simulated(world.start_s, world.advance, down)
    stopped = world.arm.encoder_pose(world.world.time_s).translation - below.translation
    assert stopped[2] > 1.5e-3, "where it met the frame, and no farther"
    assert world.controller.latched
    assert not world.arm.moving(world.world.time_s)


@pytest.mark.figures  # beside the frame that stands too high
def test_a_deck_that_is_thicker_than_stated_meets_its_frame_slowly() -> None:
    # The bound of `docs/mating.md`, "Over the station": what is pressed until the arm stands.
    world = MatingCell.drawn(9, stiffness_n_m=1e6, stop_latency_s=LATENCY_S)
    run, below = run_on(world), raised(world, -0.013)

    async def down() -> None:
        await run.move_near_frame(below, world.flange_T_deck)

    with pytest.raises(ForceLimitExceeded):
        run_simulated(world.start_s, world.advance, down)
    assert world.world.payload.peak_contact_force_n < 28.0 + 1e6 * 0.002 * LATENCY_S


@pytest.mark.long
@pytest.mark.parametrize("free_force_n", [2000.0, 300.0])
def test_a_joint_move_at_the_taught_speed_is_watched_and_its_inertia_allowed(
    free_force_n: float,
) -> None:
    world = MatingCell.drawn(7, stiffness_n_m=1e6, stop_latency_s=LATENCY_S)
    cell = cell_of(world)
    sensor = cell.arm.sensor.model_copy(update={"free_force_n": free_force_n})
    home_rad = np.radians(cell.main_config.poses_deg["home"])

    async def go_home() -> None:
        await move_joint_free(cell.cell, replace(cell.arm, sensor=sensor), home_rad)

    if free_force_n > 1000.0:
        run_simulated(world.start_s, world.advance, go_home)
        np.testing.assert_allclose(world.arm.joints(world.world.time_s), home_rad, atol=1e-6)
        return
    with pytest.raises(ForceLimitExceeded):
        run_simulated(world.start_s, world.advance, go_home)
    assert world.controller.latched
