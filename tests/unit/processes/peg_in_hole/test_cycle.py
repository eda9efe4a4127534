import asyncio
import json

import numpy as np
import pytest

from cellctl.processes.peg_in_hole.cycle import CycleLog, CyclePlan, CycleResult, search_and_insert
from cellctl.processes.peg_in_hole.faults import HoleAbsent, PegSlipped, SearchGaveUp
from cellctl.processes.peg_in_hole.plan.choice import choose_search
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.face import FacePlan, touch_face
from cellctl.processes.peg_in_hole.verdict.judgement import PegSeatLimits
from cellctl.processes.peg_in_hole.verdict.lateral import push_force_n
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import pin, plug

SOFT_PIN = pin(stiffness_n_m=1e5)


def planned(task: SearchTask, grip_force_n: float | None) -> CyclePlan:
    seat = PegSeatLimits(5.0, task.limits.insertion_n + 5)
    radius_m = 15e-3 if task.fit.rim_m else 8e-3
    return CyclePlan(task, choose_search(task), seat, FacePlan(radius_m, 3e-3), grip_force_n)


def over(task: SearchTask, seed: int, *, absent: bool = False) -> KinematicMotions:
    rng = np.random.default_rng(seed)
    drawn = Truth.draw(task, rng)
    return KinematicMotions(task, Truth(drawn.hole_m, drawn.slope, absent), rng)


async def run_cycle(
    motions: KinematicMotions, plan: CyclePlan, phases: list[CyclePhase] | None = None
) -> CycleResult:
    """A cycle from above the face; the map of heights has its face where frame A has it."""

    async def begin(phase: CyclePhase, words: str) -> None:
        assert words
        if phases is not None:
            phases.append(phase)

    await touch_face(motions, plan.task, plan.face)
    return await search_and_insert(motions, plan, 0.0, CycleLog.of(plan), begin)


@pytest.mark.parametrize("task", [plug(), pin(chamfer_mm=0.5), SOFT_PIN])
def test_a_peg_is_brought_to_its_seat_and_judged(task: SearchTask) -> None:
    # About one search in fifty of the tight pin comes to its time limit: none of these does.
    for seed in range(3, 8):
        motions = over(task, seed)
        result = asyncio.run(run_cycle(motions, planned(task, grip_force_n=200.0)))
        assert result.judgement.fault is None
        # The truth says the same; the arm still pushes at one wall along each axis, and where each
        # touch ended is known no better than to its noise.
        yields_m = push_force_n(task.cell) / task.cell.stiffness_n_m
        noise_m = 4 * task.cell.height_sigma_m
        off_m = float(np.max(np.abs(motions.true_offset_m)))
        assert off_m <= task.fit.clearance_m + yields_m + noise_m
        assert motions.position_m[2] > task.fit.depth_m - 0.3e-3
        json.dumps(result.to_record())


def test_the_phases_are_told_before_they_begin() -> None:
    phases: list[CyclePhase] = []
    asyncio.run(run_cycle(over(SOFT_PIN, 1), planned(SOFT_PIN, 200.0), phases))
    assert phases == [
        CyclePhase.SEARCH,
        CyclePhase.SEARCH,
        CyclePhase.INSERTION,
        CyclePhase.VERDICT,
    ]


def test_without_a_known_grip_force_nothing_is_called_inserted() -> None:
    result = asyncio.run(run_cycle(over(SOFT_PIN, 1), planned(SOFT_PIN, None)))
    assert isinstance(result.judgement.fault, PegSlipped)


@pytest.mark.parametrize("task", [plug(), SOFT_PIN])
def test_without_a_hole_nothing_is_inserted(task: SearchTask) -> None:
    motions = over(task, 2, absent=True)
    with pytest.raises((HoleAbsent, SearchGaveUp)):
        asyncio.run(run_cycle(motions, planned(task, 200.0)))
    assert motions.position_m[2] < task.fit.entry_depth_m
