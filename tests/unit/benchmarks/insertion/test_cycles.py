"""Whole cycles over the contact model, without the wire."""

import asyncio

import numpy as np
import pytest
from rich.console import Console

from benchmarks.insertion.contact_world import ContactWorld, Imperfections
from benchmarks.insertion.cycle_campaign import table
from benchmarks.insertion.cycles import CycleCell, CycleOutcome, run_cycle
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.guard.report import TripReason
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from cellctl.processes.peg_in_hole.stations import believed_frames
from fakes.scenes.socket.part import draw_part
from fakes.scenes.socket.peaks import ForcePeaks
from fakes.world.frames import displacement, from_written

EXACT = Imperfections(0.0, 0.0, 1e-9, 1e-9)
DOWN_M = 20e-6


@pytest.fixture(scope="module")
def cell() -> CycleCell:
    return CycleCell.shipped("pin")


def lowered(cell: CycleCell, imperfections: Imperfections, force_n: float) -> ContactWorld:
    """Straight down beside the hole until the face carries with a force."""
    above = from_written(cell.scenario.taught["arm"]["above_hole"])
    flange = above.as_matrix()
    flange[0, 3] += 10e-3
    part = draw_part(cell.scenario, 3, 1)
    rng = np.random.default_rng(3)
    world = ContactWorld(cell.scenario, part, above, imperfections, rng)
    world.tare(believed_frames(cell.recipe, above))
    for _ in range(400):
        world.tick(flange)
    while np.linalg.norm(world.peg.wrench[:3]) < force_n:
        flange = flange.copy()
        flange[2, 3] -= DOWN_M
        world.tick(flange)
    return world


def test_the_guard_feels_what_the_face_does_to_the_peg(cell: CycleCell) -> None:
    world = lowered(cell, EXACT, 6.0)
    for _ in range(20):
        world.tick(world.flange)
    newest = world.guard.samples(world.now_s - 2e-3).wrench[-1]
    # The face is level to a degree: it pushes against the tip, whose z points into the hole.
    assert newest[2] == pytest.approx(-np.linalg.norm(world.peg.wrench[:3]), rel=0.02)
    assert world.peg.steps > 0
    assert not world.seated


def test_a_wrench_about_the_base_has_the_moment_of_its_lever(cell: CycleCell) -> None:
    world = lowered(cell, EXACT, 2.0)
    wrenches, tips_m = np.random.default_rng(2).normal(0.0, 5.0, (2, 50, 6))
    about = world._about_base(wrenches, tips_m[:, :3])
    turn = world._hole[:3, :3]
    for told, wrench, tip_m in zip(about, wrenches, tips_m[:, :3], strict=True):
        force = turn @ wrench[:3]
        moment = turn @ wrench[3:] + np.cross(turn @ tip_m + world._hole[:3, 3], force)
        np.testing.assert_allclose(told, [*force, *moment], rtol=0, atol=1e-12)


def test_the_guard_trips_at_the_limits_that_it_was_given(cell: CycleCell) -> None:
    world = lowered(cell, EXACT, 2.0)
    limits = guard_limits((5.0, 5.0, 5.0, 1.0, 1.0, 1.0), Sensing(1000.0, 0.01, 0.1))
    asyncio.run(world.guard.arm(limits))
    assert world.guard.trip is None
    flange = world.flange.copy()
    flange[2, 3] -= 0.2e-3
    for _ in range(30):
        world.tick(flange)
    assert world.guard.trip is not None
    assert world.guard.trip.reason is TripReason.FILTERED_LIMIT


def test_the_same_seed_gives_the_same_forces(cell: CycleCell) -> None:
    noisy = Imperfections(0.02e-3, 0.01e-3, 0.2, 0.005)
    first, second = (lowered(cell, noisy, 3.0) for _ in range(2))
    assert first.peg.wrench.tolist() == second.peg.wrench.tolist()
    assert first.guard.samples(0.0).wrench.tolist() == second.guard.samples(0.0).wrench.tolist()


@pytest.mark.long
@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", ["pin", "connector"])
def test_a_part_is_inserted_and_called_so(name: str) -> None:
    one = CycleCell.shipped(name)
    outcome = run_cycle(one, 1)
    assert outcome.called_good
    assert outcome.seated
    assert not outcome.fault
    limits = one.plan.task.limits
    assert outcome.peak_n(CyclePhase.INSERTION, 20) < limits.insertion_n
    assert outcome.peak_n(CyclePhase.SEARCH, 20) < 1.5 * limits.search_n
    assert outcome.unsolved_share < 0.02


def test_the_table_tells_what_is_called_inserted_and_is_not() -> None:
    peaks = {CyclePhase.SEARCH: ForcePeaks({1: 9.0, 3: 8.0, 20: 7.0}, {1: 0.1, 3: 0.1, 20: 0.1})}
    outcomes = [
        CycleOutcome(1, called_good=True, seated=True, search_s=10.0, cycle_s=40.0, peaks=peaks),
        CycleOutcome(2, called_good=True, seated=False, search_s=10.0, cycle_s=40.0),
        CycleOutcome(3, fault="F547"),
    ]
    console = Console(width=160, record=True, quiet=False)
    with console.capture() as shown:
        console.print(table({"pin": outcomes}))
    said = shown.get()
    assert "1 (6.1 to 79.2 %)" in said
    assert "1 F547" in said
    assert "7.0 of 12" in said
    (false,) = [line for line in said.splitlines() if "are not" in line]
    assert "1" in false


def test_a_longer_step_than_the_shipped_cells_allow_is_refused(cell: CycleCell) -> None:
    above = from_written(cell.scenario.taught["arm"]["above_hole"])
    part, rng = draw_part(cell.scenario, 3, 1), np.random.default_rng(3)
    stream = ContactWorld(cell.scenario, part, above, EXACT, rng).stream

    def advance(shift_m: float, turn_rad: float = 0.0) -> None:
        turned = above * displacement([0.0, 0.0, 0.0], [turn_rad, 0.0, 0.0])
        asyncio.run(stream.advance(displacement([shift_m, 0.0, 0.0], [0.0, 0.0, 0.0]) * turned))

    advance(0.09e-3)
    advance(0.18e-3, 0.8e-3)
    with pytest.raises(TargetOutOfBounds):
        advance(0.29e-3, 0.8e-3)
    with pytest.raises(TargetOutOfBounds):
        advance(0.18e-3, 1.7e-3)
