"""The acceptance table: every requirement with value, expanded uncertainty, limit and verdict."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from cellctl.geometry.coverage import COVERAGE_FACTOR
from cellctl.records.entered.gauges import gauge_limits, judge_gauge
from cellctl.records.entries import RunRecord, Verdict
from cellctl.records.figures import NO_LIMIT, Limit
from cellctl.records.report.acceptance.requirement import (
    Requirement,
    RequirementGroup,
    of_figure,
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

TITLE = "Acceptance"
_COLUMNS = ("requirement", "measured", "U", "required", "accepted", "verdict", "found in")
_LEGEND = (
    f"U: expanded uncertainty, coverage factor k = {COVERAGE_FACTOR:g}, level of confidence about "
    "95 % (JCGM 100): the value is known to ± U. Where a row has an accepted range, it is the "
    "required one less U, and the measured value must lie in it (JCGM 106, guarded acceptance). "
    "Rows without an accepted range are judged by the required range alone, marked "
    "(< U) where the margin is below U; a dash as U means that "
    "no uncertainty was evaluated for that value."
)
_VERDICTS = {
    Verdict.PASS: ("✓ conforms", RowMark.GOOD),
    Verdict.FAIL: ("✗ does not conform", RowMark.BAD),
}


def acceptance(record: RunRecord, brought: Sequence[RequirementGroup]) -> ReportSection:
    """What a process brings first, then the plug gauges, then every other figure with a limit."""
    groups = (*brought, *_gauges(record), *_others(record, brought))
    phases = {phase.id: phase.label for phase in record.phases}
    rows = tuple(row for group in groups for row in _rows(group, phases))
    table = ReportTable(_COLUMNS, rows, numbers=False)
    return ReportSection(TITLE, (table, Note(_LEGEND)) if rows else ())


def _rows(group: RequirementGroup, phases: Mapping[int, str]) -> Iterator[TableRow]:
    if group.requirements:
        yield TableRow((TableCell(group.title, group.note),), RowMark.GROUP)
    for entry in group.requirements:
        verdict, mark = _verdict(entry)
        unit = entry.unit
        # Two figures of an uncertainty mean something, and the value has as many decimals
        # (JCGM 100, 7.2.6); so has what it is compared with.
        places = _places(entry.expanded)
        texts = (
            entry.title,
            _rounded(entry.value, unit, places),
            _rounded(entry.expanded, unit, places),
            limit_text(entry.required, unit),
            limit_text(entry.accepted, unit, places),
            verdict,
            phases.get(entry.phase or 0, MISSING),
        )
        yield TableRow(tuple(TableCell(text) for text in texts), mark)


def _places(expanded: float | None) -> int | None:
    """Decimals of an uncertainty with two figures; None where there is none to go by."""
    if expanded is None or not expanded > 0:
        return None
    return max(0, 1 - math.floor(math.log10(expanded)))


def _rounded(value: float | None, unit: str, places: int | None) -> str:
    if places is None or value is None:
        return quantity(value, unit).replace("-", "−")
    return with_unit(fixed(value, places), unit)


def _verdict(entry: Requirement) -> tuple[str, RowMark]:
    if entry.verdict is None:
        return ("not measured" if entry.value is None else "no limit known"), RowMark.NONE
    text, mark = _VERDICTS[entry.verdict]
    return (f"{text} (< U)" if _closer_than_u(entry) else text), mark


def _closer_than_u(entry: Requirement) -> bool:
    """Whether a row that is judged without a guard band conforms by less than its uncertainty."""
    if entry.verdict is not Verdict.PASS or entry.accepted != NO_LIMIT:
        return False
    bounds = (bound for bound in (entry.required.lower, entry.required.upper) if bound is not None)
    if entry.value is None or entry.expanded is None:
        return False
    return any(abs(bound - entry.value) < entry.expanded for bound in bounds)


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
    note = "largest plug gauge that passes; entered by hand"
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
    shown = {entry.figure for group in brought for entry in group.requirements}
    found = (of_figure(record, key) for key in record.newest_figures if key not in shown)
    rows = tuple(entry for entry in found if entry is not None)
    yield RequirementGroup("Further figures with a limit" if shown else "Figures", rows)
