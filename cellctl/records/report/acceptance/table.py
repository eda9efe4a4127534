"""The acceptance table: every requirement with value, expanded uncertainty, limit and verdict."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from cellctl.geometry.coverage import COVERAGE_FACTOR
from cellctl.records.entered.gauges import gauge_limits, judge_gauge
from cellctl.records.entries import RunRecord, Verdict
from cellctl.records.figures import (
    NO_LIMIT,
    NOT_DECIDED,
    NOT_MEASURED,
    WITHIN_THRESHOLD,
    Limit,
    is_undecided,
)
from cellctl.records.report.acceptance.requirement import (
    Requirement,
    RequirementGroup,
    missing,
    of_figure,
    on_page,
)
from cellctl.records.report.sections import (
    Note,
    ReportSection,
    ReportTable,
    RowMark,
    TableCell,
    TableRow,
)
from cellctl.records.report.text import MISSING, fixed, quantity, with_unit
from cellctl.records.required.required_figures import not_measured

TITLE = "Acceptance"
_COLUMNS = ("requirement", "measured", "U", "required", "accepted", "verdict", "found in")
NOT_STATED = "not stated"
_LEGEND = (
    f"U: expanded uncertainty, coverage factor k = {COVERAGE_FACTOR:g}, level of confidence about "
    "95 % (JCGM 100): the value is known to ± U. In the other tables of this report u is a "
    "standard uncertainty, one standard deviation; ± stands for U and for limits alone. Where a "
    "row has an accepted range, it is the required one less U, and the measured value must lie in "
    "it (JCGM 106, guarded acceptance). "
    "A row without an accepted range is judged by the required one alone, and not decided where "
    "its value lies within that by less than U (ISO 14253-1). "
    "A threshold at which a correction ends is no requirement on the part: the value as measured "
    "is compared with it. "
    f"Where U is {NOT_STATED}, none was evaluated: the value as measured is compared with the "
    "limit (JCGM 106, 8.2, simple acceptance), and the verdict does not say how likely the true "
    "value lies beyond it. Plug gauges are optional and entered by hand after a run; one that "
    "does not conform makes the part a bad one."
)
_VERDICTS = {
    Verdict.PASS: ("✓ conforms", RowMark.GOOD),
    Verdict.FAIL: ("✗ does not conform", RowMark.BAD),
}
_OF_THRESHOLDS = {
    Verdict.PASS: (WITHIN_THRESHOLD, RowMark.NONE),
    Verdict.FAIL: ("✗ beyond threshold", RowMark.BAD),
}


def acceptance(record: RunRecord, brought: Sequence[RequirementGroup]) -> ReportSection:
    """What a process brings on the part, the plug gauges, what it brings on the way there, then
    every other figure with a limit.

    A table that is longer than the first sheet goes on behind the signatures: gauges that were
    entered are of the part and stand on that sheet; nobody misses there those that were not.
    """
    gauges = tuple(_gauges(record))
    ahead = gauges if record.gauges else ()
    behind = () if ahead else gauges
    groups = (*brought[:1], *ahead, *brought[1:], *behind, *_others(record, brought))
    phases = {phase.id: phase.label for phase in record.phases}
    rows = tuple(row for group in groups for row in _rows(group, phases))
    table = ReportTable(_COLUMNS, rows, numbers=False)
    return ReportSection(TITLE, (table, Note(_LEGEND)) if rows else ())


def _rows(group: RequirementGroup, phases: Mapping[int, str]) -> Iterator[TableRow]:
    if group.requirements:
        yield TableRow((TableCell(group.title, group.note),), RowMark.GROUP)
    for found in group.requirements:
        entry = on_page(found)
        verdict, mark = _verdict(entry)
        unit = entry.unit
        # Two figures of an uncertainty mean something, and the value has as many decimals
        # (JCGM 100, 7.2.6); so has what it is compared with.
        places = _places(entry.expanded)
        texts = (
            entry.title,
            _rounded(entry.value, unit, places),
            _uncertainty(entry, places),
            limit_text(entry.required, unit),
            limit_text(entry.accepted, unit, places),
            verdict,
            phases.get(entry.phase or 0, MISSING),
        )
        yield TableRow(tuple(TableCell(text) for text in texts), mark)


def _uncertainty(entry: Requirement, places: int | None) -> str:
    """The uncertainty in the table; a dash where there is no value."""
    if entry.expanded is None and entry.value is not None and entry.verdict is not None:
        return NOT_STATED
    return _rounded(entry.expanded, entry.unit, places)


def _places(expanded: float | None) -> int | None:
    """Decimals that show two digits of an uncertainty; None without an uncertainty."""
    if expanded is None or not expanded > 0:
        return None
    return max(0, 1 - math.floor(math.log10(expanded)))


def _rounded(value: float | None, unit: str, places: int | None) -> str:
    if places is None or value is None:
        return quantity(value, unit).replace("-", "−")
    return with_unit(fixed(value, places), unit)


def _verdict(entry: Requirement) -> tuple[str, RowMark]:
    if entry.verdict is None:
        return ("optional, not entered" if entry.value is None else "no limit known"), RowMark.NONE
    if entry.value is None and entry.verdict is Verdict.FAIL:
        return f"✗ {NOT_MEASURED}", RowMark.BAD
    if entry.threshold:
        return _OF_THRESHOLDS[entry.verdict]
    if entry.accepted == NO_LIMIT and is_undecided(entry.value, entry.required, entry.expanded):
        return f"? {NOT_DECIDED}: {_too_wide(entry)}", RowMark.NONE
    return _VERDICTS[entry.verdict]


def _too_wide(entry: Requirement) -> str:
    """What an undecided value is known too badly for."""
    bounds = [bound for bound in (entry.required.lower, entry.required.upper) if bound is not None]
    # A magnitude has one limit, and a deviation two: nothing within U of both could be decided.
    room = abs(bounds[0]) if len(bounds) == 1 else (bounds[1] - bounds[0]) / 2.0
    return "U > limit" if (entry.expanded or 0.0) > room else "U > margin"


def limit_text(limit: Limit, unit: str, places: int | None = None) -> str:
    """A limit in signs: ``≤ 0.2 mm``, ``± 0.1 mm``, ``2.35 to 2.65 mm``; a dash for none.

    ``places``: decimals, or as many as the numbers need.
    """
    lower, upper = limit.lower, limit.upper
    if lower is not None and upper is not None:
        if lower == -upper:
            return f"± {_rounded(upper, unit, places)}"
        return f"{_rounded(lower, '', places)} to {_rounded(upper, unit, places)}"
    if upper is not None:
        return f"≤ {_rounded(upper, unit, places)}"
    return MISSING if lower is None else f"≥ {_rounded(lower, unit, places)}"


def _gauges(record: RunRecord) -> Iterator[RequirementGroup]:
    """Every hole that may be gauged, also one that nobody has gauged yet."""
    limits = gauge_limits(record)
    newest = {gauge.hole: gauge for gauge in record.gauges}
    names = dict.fromkeys((*limits, *newest))
    rows = (_gauge(record, name, limits.get(name, NO_LIMIT)) for name in names)
    note = "largest plug gauge that passes; optional, entered by hand after the run"
    yield RequirementGroup("Plug gauges", tuple(rows), note)


def _gauge(record: RunRecord, hole: str, limit: Limit) -> Requirement:
    entry = next((gauge for gauge in record.gauges if gauge.hole == hole), None)
    # What was entered first and then replaced is part of what is signed below the table.
    earlier = [gauge for gauge in record.gauge_history if gauge.hole == hole and gauge != entry]
    replaced = ", ".join(f"{gauge.diameter_mm:.2f} mm of {gauge.source}" for gauge in earlier)
    return Requirement(
        title=f"gauge through hole {hole}" + (f" (replaces {replaced})" if replaced else ""),
        value=None if entry is None else entry.diameter_mm,
        unit="mm",
        required=limit,
        verdict=None if entry is None else judge_gauge(record, entry),
    )


def _others(record: RunRecord, brought: Iterable[RequirementGroup]) -> Iterator[RequirementGroup]:
    lines = [entry for group in brought for entry in group.requirements]
    shown = {entry.figure for entry in lines} | {entry.stands_for for entry in lines}
    found = (of_figure(record, key) for key in record.newest_figures if key not in shown)
    lacking = (missing(one) for one in not_measured(record) if one.key not in shown)
    rows = (*(entry for entry in found if entry is not None), *lacking)
    yield RequirementGroup("Further figures with a limit" if shown else "Figures", rows)
