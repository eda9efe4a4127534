"""Whether a fault ended as it must: a pure function of what was seen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.faults.observation import Effect, Moved, Observation

RESTING_STATES = frozenset({"Aborted", "Stopped", "Held"})
BACKS_OFF_AFTER = frozenset({501, 502, 503, 504, 505, 512, 522, 523, 525, 526, 527, 704})
"""The faults after which the arm leaves the frame by itself, as docs/operating.md says."""
OF_CALIBRATIONS = 0x106
"""Reject code of a Start for want of calibrations: only a false time of day makes them invalid."""
BACK_OFF_MM = 2.2
"""2 mm, and what the arm adds to it."""
AFTER_END_S = 0.3
"""The line learns of a state so much later than the cell has it: one turn of its polling."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """Figures of one cell of the table, and everything that is wrong with it."""

    standstill_s: float | None
    """Time from the fault to the end of the last motion; None if it never ended."""
    travel_mm: float
    """The longest way of any arm after the fault."""
    turn_deg: float
    """The greatest turn of any arm after the fault."""
    backed_off_mm: float
    wrong: Sequence[str]

    @property
    def passed(self) -> bool:
        """Nothing is wrong."""
        return not self.wrong


def judge(seen: Observation) -> Judgement:
    """Hold what was seen against what is demanded."""
    leaving = _back_off(seen)
    others = [motion for motion in seen.motions if motion not in leaving]
    ends = [motion.ended_s for motion in others]
    standstill_s = None if None in ends else max((end for end in ends if end), default=0.0)
    wrong = [
        *_motion(seen, others, standstill_s),
        *_force(seen),
        *_line(seen),
        *_record(seen),
    ]
    return Judgement(
        standstill_s,
        _greatest(others, lambda motion: motion.travel_mm),
        _greatest(others, lambda motion: motion.turn_deg),
        sum(motion.travel_mm for motion in leaving),
        wrong,
    )


def _greatest(motions: Sequence[Moved], size: Callable[[Moved], float]) -> float:
    """The largest sum over the motions of one arm."""
    arms = {motion.arm for motion in motions}
    sums = [sum(size(motion) for motion in motions if motion.arm == arm) for arm in arms]
    return max(sums, default=0.0)


def _back_off(seen: Observation) -> list[Moved]:
    """Motions straight up from the frame, where they are allowed."""
    if not BACKS_OFF_AFTER & set(seen.shown):
        return []
    up = [
        motion
        for motion in seen.motions
        if motion.begun_s > 0 and motion.rise_mm > 0.9 * motion.travel_mm
    ]
    return up if sum(motion.travel_mm for motion in up) <= BACK_OFF_MM else []


def _motion(seen: Observation, others: Sequence[Moved], standstill_s: float | None) -> list[str]:
    if standstill_s is None:
        return ["an arm still moved when the watch ended"]
    wrong = []
    expected = seen.expected
    if expected.effect is not Effect.AT_NEXT_USE and standstill_s > expected.bound_s:
        wrong.append(f"stood after {standstill_s:.2f} s, bound {expected.bound_s:.2f} s")
    if expected.effect is Effect.MOVE_ENDS and any(
        motion.begun_s > expected.noticed_s for motion in others
    ):
        wrong.append("a move began when the fault was known")
    if seen.ended_s is not None:
        late = [motion for motion in seen.motions if motion.begun_s > seen.ended_s + AFTER_END_S]
        wrong += [f"{motion.arm} moved again after {seen.state}" for motion in late]
    return wrong


def _force(seen: Observation) -> list[str]:
    bound_n = seen.expected.peak_bound_n
    return [f"peak {seen.peak_n:.1f} N, bound {bound_n:.0f} N"] if seen.peak_n > bound_n else []


def _line(seen: Observation) -> list[str]:
    if seen.expected.line_silent:
        return []
    if seen.refused and seen.state == "Idle":
        elsewhere = seen.refused == OF_CALIBRATIONS and seen.fault != "clock-back"
        return ["Start was refused for the calibrations"] if elsewhere else []
    wrong = []
    if seen.state not in RESTING_STATES:
        wrong.append(f"moved on to {seen.state}")
    if not seen.shown:
        wrong.append("the line saw no alarm")
    return wrong


def _record(seen: Observation) -> list[str]:
    wrong = [] if seen.idle_again else ["did not come back to Idle"]
    if seen.restarted and not seen.expected.may_restart:
        wrong.append("came back to Idle only with a new daemon")
    if seen.record == "good":
        wrong.append("the record says good")
    elif seen.record == "open":
        wrong.append("the record was left open")
    elif seen.record is None and seen.expected.has_record and not seen.refused:
        wrong.append("there is no record")
    return wrong
