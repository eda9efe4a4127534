"""How long a run will still take, by the last good ones of its recipe."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from statistics import median

from cellctl.hmi.answers.form import Form
from cellctl.records.entries import Phase


class TimeLeft(Form):
    """Where a run is among the steps of the last good ones. All null without such a run."""

    number: int | None
    """Number of the step that is under way, as the line sees it."""
    step: int | None
    """Its place among them, from 1 on; null for one that they did not have."""
    of: int | None
    """How many steps they had."""
    left_s: float | None
    """What the rest of this step and the steps after it take as a rule, seconds; never below 0."""
    longer: bool
    """The step takes longer than usual: `left_s` is that of the steps after it."""
    by_runs: int
    """How many good runs say so."""


@dataclass(frozen=True, slots=True)
class UsualStep:
    """A step as good runs have had it."""

    number: int
    seconds: float
    """Median of the runs: one that was held for an hour does not count for more than any other."""


NOTHING = TimeLeft(number=None, step=None, of=None, left_s=None, longer=False, by_runs=0)


def usual_steps(runs: Sequence[Sequence[Phase]]) -> tuple[UsualStep, ...]:
    """The steps of the newest of these good runs in their order; the newest run comes first."""
    lasted = [_lasted_s(phases) for phases in runs]
    return tuple(
        UsualStep(number, median(one[number] for one in lasted if number in one))
        for number in (lasted[0] if lasted else ())
    )


def time_left(
    phases: Sequence[Phase], usual: Sequence[UsualStep], by_runs: int, now: datetime
) -> TimeLeft:
    """Of an open run with these phases; ``now`` is by the clock that has dated them."""
    numbers = [step.number for step in usual]
    current = phases[-1] if phases else None
    if current is None or current.ended is not None or current.number not in numbers:
        return NOTHING
    at = numbers.index(current.number)
    own_s = usual[at].seconds - (now - current.began).total_seconds()
    later_s = sum(step.seconds for step in usual[at + 1 :])
    return TimeLeft(
        number=current.number,
        step=at + 1,
        of=len(usual),
        left_s=round(max(0.0, own_s) + later_s, 1),
        longer=own_s < 0.0,
        by_runs=by_runs,
    )


def _lasted_s(phases: Sequence[Phase]) -> dict[int, float]:
    """Seconds by number of the step: of steps that a Hold has begun anew, the last time."""
    lasted: dict[int, float] = {}
    for phase in phases:
        if phase.ended is not None:
            lasted[phase.number] = (phase.ended - phase.began).total_seconds()
    return lasted
