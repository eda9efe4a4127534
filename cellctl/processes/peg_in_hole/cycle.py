"""One whole cycle by touch: face, search, insertion, pushes to the sides, verdict."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from cellctl.cell.contact_motion.motions import ContactMotions
from cellctl.processes.peg_in_hole.insertion.insert import Fed, insert
from cellctl.processes.peg_in_hole.plan.choice import SearchChoice, SearchName
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.face import FacePlan, TouchedFace, touch_face
from cellctl.processes.peg_in_hole.search.find_hole import find_hole
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.probe import SearchTrace, TouchProbe
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence
from cellctl.processes.peg_in_hole.verdict.holding import (
    directions_that_resist_a_turn,
    pull_that_holds_n,
)
from cellctl.processes.peg_in_hole.verdict.judgement import PegJudgement, PegSeatLimits, judge_peg
from cellctl.processes.peg_in_hole.verdict.lateral import measure_capture

_PRESS_S = 0.1


@dataclass(frozen=True, slots=True)
class CyclePlan:
    """What one cycle is asked to do; made before anything moves."""

    task: SearchTask
    choice: SearchChoice
    seat: PegSeatLimits
    face: FacePlan
    grip_force_n: float | None
    """None where nobody has measured it: the touch on the rear is needed then."""


@dataclass(frozen=True, slots=True, eq=False)
class CycleResult:
    """What one cycle has found."""

    face: TouchedFace
    found_by: SearchName
    fed: Fed
    evidence: InsertionEvidence
    judgement: PegJudgement

    def to_record(self) -> Mapping[str, Any]:
        """Plain data, without path and curve."""
        return {
            "found_by": self.found_by.value,
            "face_tilt_rad": self.face.tilt_rad,
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
    """None until the peg has entered."""

    @classmethod
    def of(cls, plan: CyclePlan) -> Self:
        """Nothing felt yet."""
        return cls(HoleMap(plan.task.cell.uncertainty_m, plan.task.fit.catch_radius_m))


def _silent(_words: str) -> None:
    return


async def run_cycle(motions: ContactMotions, plan: CyclePlan) -> CycleResult:
    """From above the face to the verdict, held by the gripper still; see ``search_and_insert``."""
    face = await touch_face(motions, plan.task, plan.face)
    return await search_and_insert(motions, plan, face, CycleLog.of(plan))


async def search_and_insert(
    motions: ContactMotions,
    plan: CyclePlan,
    face: TouchedFace,
    log: CycleLog,
    tell: Callable[[str], None] = _silent,
) -> CycleResult:
    """From the touched face to the verdict; ``log`` takes what is felt on the way.

    ``tell`` hears what is being done. Raises what search and insertion raise; then the caller
    decides about the way out. Without a touch on the part's rear the verdict rests on the grip
    force alone.
    """
    task = plan.task
    order = ", then ".join(name.value for name in plan.choice.order)
    tell(f"search: {order}")
    # For its time stamp: the deadline of the search counts on the clock of the samples.
    begun = (await motions.press(task.limits.search_n, _PRESS_S)).last
    probe = TouchProbe(
        motions,
        task,
        plan.choice.parameters,
        log.hole_map,
        begun.time_s + task.search_limit_s,
        trace=log.trace,
    )
    found_by = log.found_by = await find_hole(probe, plan.choice.order)
    tell(f"insert: the hole was found by {found_by.value}")
    fed = await insert(motions, task)
    tell("verify: pushed to four sides")
    capture = await measure_capture(motions, task)
    keys, pull_n = task.fit.keys, plan.seat.pull_n
    keyed = None if keys is None else await directions_that_resist_a_turn(motions, keys)
    held_n = None if pull_n is None else await pull_that_holds_n(motions, task, pull_n)
    evidence = InsertionEvidence(
        depth_m=fed.depth_m - face.depth_m,
        seat_force_n=fed.seat_force_n,
        seat_slope_n_m=fed.seat_slope_n_m,
        capture=capture,
        # The part may as well have slipped in the search, which presses up to its own limit.
        greatest_force_n=max(fed.greatest_force_n, task.limits.search_n),
        grip_force_n=plan.grip_force_n,
        retouch_error_m=None,
        keyed_directions=keyed,
        held_pull_n=held_n,
    )
    judgement = judge_peg(evidence, task, plan.seat)
    return CycleResult(face, found_by, fed, evidence, judgement)
