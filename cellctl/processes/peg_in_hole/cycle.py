"""One cycle by touch on a face that was touched: search, insertion, pushes, verdict."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from cellctl.cell.contact_motion.motions import ContactMotions
from cellctl.processes.peg_in_hole.first_contact.reactions import Contacts, meet_face, require_walls
from cellctl.processes.peg_in_hole.insertion.insert import Fed, insert
from cellctl.processes.peg_in_hole.plan.choice import SearchChoice, SearchName
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.conditions import against_a_wall
from cellctl.processes.peg_in_hole.search.face import CLEAR_M, FacePlan
from cellctl.processes.peg_in_hole.search.find_hole import find_hole
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.probe import TOUCH_SHARE, SearchTrace, TouchProbe
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence
from cellctl.processes.peg_in_hole.verdict.holding import (
    directions_that_resist_a_turn,
    pull_that_holds_n,
)
from cellctl.processes.peg_in_hole.verdict.judgement import PegJudgement, PegSeatLimits, judge_peg
from cellctl.processes.peg_in_hole.verdict.lateral import measure_capture

_PRESS_S = 0.1
"""Length of the first press, which only has to give the search the time at which it begins."""
_FREE_M_S = 10e-3
"""Greatest speed over the face, which was touched before."""
_DOWN = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class CyclePlan:
    """What one cycle is asked to do; made before anything moves."""

    task: SearchTask
    choice: SearchChoice
    seat: PegSeatLimits
    face: FacePlan
    grip_force_n: float | None
    """Force with which the gripper holds the peg; None where nobody has measured it: the touch on
    the rear is needed then."""


@dataclass(frozen=True, slots=True, eq=False)
class CycleResult:
    """What one cycle has found."""

    found_by: SearchName
    fed: Fed
    evidence: InsertionEvidence
    judgement: PegJudgement

    def to_record(self) -> Mapping[str, Any]:
        """Plain data, without path and curve."""
        return {
            "found_by": self.found_by.value,
            "recoveries": list(self.fed.recoveries),
            "evidence": self.evidence.to_record(),
            "judgement": self.judgement.to_record(),
        }


@dataclass(slots=True, eq=False)
class CycleLog:
    """What one cycle has felt so far; its caller keeps it where the cycle fails, too."""

    hole_map: HoleMap
    trace: SearchTrace = field(default_factory=SearchTrace)
    found_by: SearchName | None = None
    """The search that found the hole; None until the peg has entered."""
    contacts: Contacts = field(default_factory=list)

    @classmethod
    def of(cls, plan: CyclePlan) -> Self:
        """Nothing felt yet."""
        return cls(HoleMap(plan.task.cell.uncertainty_m, plan.task.fit.catch_radius_m))


def greatest_before_n(task: SearchTask) -> float:
    """Upper bound of the force (N) on the part during the search, in which it may have slipped,
    too.

    A greater force would have tripped the guard, and there would be no verdict. Touching the face
    does not count: a part that slipped then did so before the touches that frame A rests on.
    """
    return guard_force(task, CyclePhase.SEARCH).value


BeginPhase = Callable[[CyclePhase, str], Awaitable[None]]
"""Called before the first motion of a phase, with words for the operator."""


async def search_and_insert(
    motions: ContactMotions,
    plan: CyclePlan,
    face_yields_m: float,
    log: CycleLog,
    begin: BeginPhase,
) -> CycleResult:
    """From over the touched face, where frame A lies, to the verdict; ``log`` takes what is felt.

    ``face_yields_m``: of the touches that frame A was laid by. Raises what search and insertion
    raise; then the caller decides about the way out. Without a touch on the part's rear the verdict
    rests on the grip force alone.
    """
    task = plan.task
    order = ", then ".join(name.value for name in plan.choice.order)
    await begin(CyclePhase.SEARCH, "touch the face over its middle")
    await motions.move_free(np.array([0.0, 0.0, -CLEAR_M]), np.zeros(3), _FREE_M_S)
    parameters = plan.choice.parameters
    await motions.touch(
        _DOWN, 2 * CLEAR_M, TOUCH_SHARE * task.limits.search_n, parameters.touch_speed.value
    )
    # For its time stamp: the deadline of the search counts on the clock of the samples.
    press_n = parameters.press_n.value
    walled = against_a_wall(press_n, task.cell)
    begun = (await motions.press(press_n, _PRESS_S, walled)).last
    probe = TouchProbe(
        motions,
        task,
        parameters,
        log.hole_map,
        begun.time_s + task.search_limit_s,
        trace=log.trace,
    )
    await meet_face(motions, task, parameters, log.contacts)
    first_contact = log.contacts[-1].found
    await begin(CyclePhase.SEARCH, f"search: {order}; first contact: {first_contact.value}")
    found_by = log.found_by = await find_hole(probe, plan.choice.order, first_contact)
    await require_walls(motions, task, parameters, log.contacts)
    felt = log.contacts[-1].found.value
    words = f"insert: the hole was found by {found_by.value}, {felt}"
    fed, evidence, judgement = await feed_and_judge(motions, plan, face_yields_m, begin, words)
    return CycleResult(found_by, fed, evidence, judgement)


async def feed_and_judge(
    motions: ContactMotions,
    plan: CyclePlan,
    face_yields_m: float,
    begin: BeginPhase,
    words: str = "insert",
) -> tuple[Fed, InsertionEvidence, PegJudgement]:
    """From the entry, or from over it, to the verdict; raises the faults of the insertion."""
    task = plan.task
    await begin(CyclePhase.INSERTION, words)
    fed = await insert(motions, task, face_yields_m)
    await begin(CyclePhase.VERDICT, "verify: pushed to four sides")
    capture = await measure_capture(motions, task)
    keys, pull_n = task.fit.keys, plan.seat.pull_n
    keyed = None if keys is None else await directions_that_resist_a_turn(motions, keys)
    held_n = None if pull_n is None else await pull_that_holds_n(motions, task, pull_n)
    evidence = InsertionEvidence(
        depth_m=fed.depth_m,
        seat_force_n=fed.seat_force_n,
        seat_slope_n_m=fed.seat_slope_n_m,
        held_way_m=fed.held_way_m,
        unrubbed_way_m=fed.unrubbed_way_m,
        with_feed_n=fed.with_feed_n,
        dropped_n=fed.dropped_n,
        capture=capture,
        greatest_force_n=max(fed.greatest_force_n, greatest_before_n(task)),
        grip_force_n=plan.grip_force_n,
        retouch_error_m=None,
        keyed_directions=keyed,
        held_pull_n=held_n,
    )
    return fed, evidence, judge_peg(evidence, task, plan.seat)
