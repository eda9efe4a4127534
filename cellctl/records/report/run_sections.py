"""Sections that any run has, whatever its process."""

from collections.abc import Mapping
from typing import Any

from cellctl.records.entered.gauges import GAUGE_HOLES, gauge_limits, judge_gauge
from cellctl.records.entries import (
    Gauge,
    LoopPass,
    RecordedPose,
    RunRecord,
    Verdict,
)
from cellctl.records.figures import NO_LIMIT
from cellctl.records.looks import RIMS, TAKEN
from cellctl.records.parts import PARTS, TOLD
from cellctl.records.report.sections import (
    FactList,
    Heading,
    Note,
    RecordPart,
    ReportSection,
    ReportTable,
    RowMark,
    TableCell,
    TableRow,
)
from cellctl.records.report.text import (
    MISSING,
    decimals,
    facts,
    fixed,
    number,
    plain,
    quantity,
    standard_uncertainty,
    when,
)
from cellctl.records.required.required_figures import REQUIRED
from cellctl.records.run_recorder import EXPOSURES
from cellctl.records.units import words

REPLAY_INPUT = ".input"
"""Documents of these keys are for ``cellctl replay``: numbers in full length that nobody reads."""
_SHOWN_ELSEWHERE = frozenset({GAUGE_HOLES, PARTS, EXPOSURES, TAKEN, RIMS, TOLD, REQUIRED})
FIT = "fit"
"""Entry of a pose's detail, with what ``_fit_row`` shows."""
GAUGE_VERDICTS: Mapping[Verdict | None, tuple[str, RowMark]] = {
    Verdict.PASS: ("within", RowMark.GOOD),
    Verdict.FAIL: ("beyond", RowMark.BAD),
    None: (MISSING, RowMark.NONE),
}
"""Word and mark of the row of a gauge, by the verdict on it."""


def further_figures(
    record: RunRecord, titles: Mapping[str, str], shown: frozenset[str]
) -> ReportSection:
    """Figures without a limit, and what the process knows besides figures.

    ``titles`` are what a process calls its figures, by their keys; ``shown`` are the keys of the
    documents that it shows itself.
    """
    figures = tuple(
        (titles.get(entry.key, entry.label), quantity(entry.value, entry.unit))
        for entry in record.newest_figures.values()
        if entry.verdict is None
    )
    # Each key once, in the order in which it was recorded first; ``record.document`` merges what
    # came later.
    keys = dict.fromkeys(
        entry.key
        for entry in record.documents
        if not entry.key.endswith(REPLAY_INPUT) and entry.key not in _SHOWN_ELSEWHERE | shown
    )
    documents = tuple(fact for key in keys for fact in facts(record.document(key)))
    lists = (FactList(figures), FactList(documents))
    return ReportSection("Further figures", tuple(entry for entry in lists if entry.facts))


def fits(record: RunRecord) -> ReportSection:
    """Whether the stated uncertainties explain the residuals of each fit (chi-square test)."""
    found = ((entry, entry.detail.get(FIT)) for entry in record.poses)
    rows = tuple(_fit_row(entry, fit) for entry, fit in found if fit)
    columns = ("fit of", "χ²", "degrees of freedom", "limit of χ²", "verdict", "σ multiplied by")
    note = Note(
        "Test of the stated uncertainties, not of the part: where it is not passed, the standard "
        "deviations of the pose are multiplied, and its expanded uncertainty grows with them."
    )
    table = ReportTable(columns, rows, numbers=False)
    return ReportSection("Fit statistics", (table, note) if rows else ())


def poses(record: RunRecord, tabulated: frozenset[str]) -> ReportSection:
    """Every pose with its standard deviations and the details that no other table shows."""
    columns = (
        "pose", "X mm", "Y mm", "Z mm", "A °", "B °", "C °", "residual µm", "frames",
    )  # fmt: skip
    rows = tuple(_pose_row(entry, tabulated) for entry in record.poses)
    return ReportSection("Poses", (ReportTable(columns, rows),) if rows else ())


def pass_table(entries: tuple[LoopPass, ...]) -> ReportTable:
    """The components of one loop by pass, and their limits below; at least one pass."""
    last = entries[-1]
    names = (f"{component.name} {component.unit}".rstrip() for component in last.components)
    columns = ("pass", *names, "worst / limit", "residual µm", "frames")
    limits = (
        MISSING if component.limit is None else f"± {number(component.limit)}"
        for component in last.components
    )
    cells = (TableCell(text) for text in ("limit", *limits, "1", "", ""))
    limit_row = TableRow(tuple(cells), RowMark.LIMIT)
    return ReportTable(columns, (*(_pass_row(entry) for entry in entries), limit_row))


def passes(record: RunRecord) -> ReportSection:
    """Every loop that measured and corrected."""
    blocks: list[Heading | ReportTable] = []
    for loop in dict.fromkeys(entry.loop for entry in record.passes):
        entries = tuple(entry for entry in record.passes if entry.loop == loop)
        blocks += [Heading(loop), pass_table(entries)]
    return ReportSection("Passes", tuple(blocks))


def gauges(record: RunRecord) -> ReportSection:
    """Plug gauges that a person has entered."""
    return ReportSection("Plug gauges", (gauge_table(record),) if record.gauges else ())


def gauge_table(record: RunRecord) -> ReportTable:
    """Every gauge that was ever entered, in the order of entry; the last of each hole counts."""
    columns = (
        "hole",
        "gauge mm",
        "at least",
        "at most",
        "verdict",
        "gauge",
        "measured by",
        "entered",
    )
    rows = (_gauge_row(record, entry) for entry in record.gauge_history)
    return ReportTable(columns, tuple(rows), numbers=False)


def unless_shown(record: RunRecord, shown: frozenset[RecordPart]) -> tuple[ReportSection, ...]:
    """Sections of those parts that the process does not show itself."""
    sections = {RecordPart.PASSES: passes, RecordPart.GAUGES: gauges}
    return tuple(make(record) for part, make in sections.items() if part not in shown)


def _fit_row(entry: RecordedPose, fit: Mapping[str, Any]) -> TableRow:
    chi2, limit = fit.get("chi2"), fit.get("chi2_limit")
    texts = (
        words(entry.key),
        quantity(chi2, ""),
        plain(fit.get("freedom")),
        quantity(limit, ""),
        str(fit.get("verdict", MISSING)),
        quantity(fit.get("sigma_factor"), ""),
    )
    explained = chi2 is not None and limit is not None and chi2 <= limit
    mark = RowMark.GOOD if explained else RowMark.NONE
    return TableRow(tuple(TableCell(text) for text in texts), mark)


def _pose_row(entry: RecordedPose, tabulated: frozenset[str]) -> TableRow:
    sigmas = entry.sigma_mm_deg or (None,) * 6
    columns = zip(entry.pose_mm_deg, sigmas, (3, 3, 3, 4, 4, 4), strict=True)
    rest = {
        key: value
        for key, value in entry.detail.items()
        if key not in tabulated | {FIT} and value not in ((), [], {})
    }
    return TableRow(
        cells=(
            TableCell(words(entry.key), f"{entry.origin}, {entry.parent} T {entry.child}"),
            *(_with_sigma(value, sigma, places) for value, sigma, places in columns),
            TableCell(fixed(entry.residual_um, 1)),
            TableCell(str(entry.frames or MISSING)),
        ),
        facts=tuple(facts(rest)),
    )


def _with_sigma(value: float | None, sigma: float | None, places: int) -> TableCell:
    small = "" if sigma is None else standard_uncertainty(sigma, places + 1)
    return TableCell(fixed(value, places), small)


def _pass_row(entry: LoopPass) -> TableRow:
    components = (
        TableCell(
            fixed(component.value, decimals(component.unit), signed=True),
            standard_uncertainty(component.sigma, decimals(component.unit)),
        )
        for component in entry.components
    )
    return TableRow(
        cells=(
            TableCell(str(entry.number)),
            *components,
            TableCell(fixed(entry.worst_ratio, 2)),
            TableCell(fixed(entry.residual_um, 1)),
            TableCell(str(entry.frames or MISSING)),
        ),
        mark=RowMark.GOOD if entry.converged else RowMark.NONE,
    )


def _gauge_row(record: RunRecord, entry: Gauge) -> TableRow:
    verdict, mark = GAUGE_VERDICTS[judge_gauge(record, entry)]
    replaced = entry not in record.gauges
    limit = gauge_limits(record).get(entry.hole, NO_LIMIT)
    texts = (
        entry.hole,
        fixed(entry.diameter_mm, 2),
        fixed(limit.lower, 2),
        fixed(limit.upper, 2),
        "replaced by a later entry" if replaced else verdict,
        entry.gauge_id or MISSING,
        entry.source,
        when(entry.time),
    )
    cells = tuple(TableCell(text) for text in texts)
    return TableRow(cells, RowMark.NONE if replaced else mark)
