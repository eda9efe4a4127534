"""What every inserted part has to be measured for: the items of its verdict."""

from cellctl.processes.peg_in_hole.cycle import CyclePlan
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.verdict.evidence import NOTHING_KNOWN
from cellctl.processes.peg_in_hole.verdict.judgement import RETOUCH, SLIP, judge_peg
from cellctl.records.figures import Limit
from cellctl.records.required.required_figures import RequiredFigure, required

_INSTEAD = {SLIP: RETOUCH}
"""A touch on the rear shows what no force excludes."""


def required_figures(plan: CyclePlan) -> tuple[RequiredFigure, ...]:
    """The items by which a part is judged of which nothing is known yet."""
    checks = judge_peg(NOTHING_KNOWN, plan.task, plan.seat).checks
    items = (
        required(
            keys.check(check.name),
            check.unit,
            Limit(*check.bounds),
            instead=keys.check(_INSTEAD[check.name]) if check.name in _INSTEAD else "",
        )
        for check in checks
    )
    return (required(keys.PEAK, "N", Limit(upper=plan.task.limits.insertion_n)), *items)
