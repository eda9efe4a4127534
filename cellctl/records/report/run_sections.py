"""Sections that any run has, whatever its process."""

from collections.abc import Mapping

from cellctl.records.entries import (
    Figure,
    Gauge,
    LoopPass,
    Phase,
    RecordedPose,
    RunRecord,
    Verdict,
)
from cellctl.records.figures import NO_LIMIT
from cellctl.records.gauges import gauge_limits, judge_gauge
from cellctl.records.report.sections import (
    FactList,
    Heading,
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
    duration,
    facts,
    fixed,
    number,
    quantity,
    when,
)
from cellctl.records.units import words

REPLAY_INPUT = ".input"
"""Documents of these keys are for ``cellctl replay``: numbers in full length that nobody reads."""
_MARKS = {Verdict.PASS: RowMark.GOOD, Verdict.FAIL: RowMark.BAD, None: RowMark.NONE}
_VERDICTS = {Verdict.PASS: "within", Verdict.FAIL: "beyond", None: MISSING}


def judged_figures(record: RunRecord) -> ReportSection:
    """Figures with a limit: what was required, what was found."""
    labels = _phase_labels(record)
    judged = [entry for entry in record.newest_figures.values() if entry.verdict is not None]
    columns = ("figure", "value", "at least", "at most", "verdict", "phase")
    rows = tuple(_figure_row(entry, labels) for entry in judged)
    return ReportSection(
        "Figures and limits", (ReportTable(columns, rows, numbers=False),) if rows else ()
    )


def further_figures(record: RunRecord) -> ReportSection:
    """Figures without a limit, and what the process knows besides figures."""
    figures = tuple(
        (entry.label, quantity(entry.value, entry.unit))
        for entry in record.newest_figures.values()
        if entry.verdict is None
    )
    # Each key once, in the order in which it was recorded first; ``record.document`` merges what
    # came later.
    keys = dict.fromkeys(
        entry.key for entry in record.documents if not entry.key.endswith(REPLAY_INPUT)
    )
    documents = tuple(fact for key in keys for fact in facts(record.document(key)))
    lists = (FactList(figures), FactList(documents))
    return ReportSection("Further figures", tuple(entry for entry in lists if entry.facts))


def phases(record: RunRecord) -> ReportSection:
    """When which phase began and how long it took."""
    rows = tuple(_phase_row(entry) for entry in record.phases)
    table = ReportTable(("phase", "number", "began", "duration"), rows, numbers=False)
    return ReportSection("Phases", (table,) if rows else ())


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
    columns = ("hole", "gauge mm", "at least", "verdict", "gauge", "measured by", "entered")
    rows = (_gauge_row(record, entry) for entry in record.gauge_history)
    return ReportTable(columns, tuple(rows), numbers=False)


def unless_shown(record: RunRecord, shown: frozenset[RecordPart]) -> tuple[ReportSection, ...]:
    """Sections of those parts that the process does not show itself."""
    sections = {RecordPart.PASSES: passes, RecordPart.GAUGES: gauges}
    return tuple(make(record) for part, make in sections.items() if part not in shown)


def _figure_row(entry: Figure, labels: Mapping[int, str]) -> TableRow:
    texts = (
        entry.label,
        *(quantity(value, entry.unit) for value in (entry.value, entry.lower, entry.upper)),
        _VERDICTS[entry.verdict],
        labels.get(entry.phase or 0, MISSING),
    )
    return TableRow(tuple(TableCell(text) for text in texts), _MARKS[entry.verdict])


def _phase_labels(record: RunRecord) -> Mapping[int, str]:
    return {phase.id: phase.label for phase in record.phases}


def _phase_row(entry: Phase) -> TableRow:
    texts = (entry.label, str(entry.number), when(entry.began), duration(entry.began, entry.ended))
    return TableRow(tuple(TableCell(text) for text in texts))


def _pose_row(entry: RecordedPose, tabulated: frozenset[str]) -> TableRow:
    sigmas = entry.sigma_mm_deg or (None,) * 6
    columns = zip(entry.pose_mm_deg, sigmas, (3, 3, 3, 4, 4, 4), strict=True)
    rest = {
        key: value
        for key, value in entry.detail.items()
        if key not in tabulated and value not in ((), [], {})
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
    small = "" if sigma is None else f"± {fixed(sigma, places + 1)}"
    return TableCell(fixed(value, places), small)


def _pass_row(entry: LoopPass) -> TableRow:
    components = (
        TableCell(
            fixed(component.value, decimals(component.unit), signed=True),
            f"± {fixed(component.sigma, decimals(component.unit))}",
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
    verdict = judge_gauge(record, entry)
    replaced = entry not in record.gauges
    least_mm = gauge_limits(record).get(entry.hole, NO_LIMIT).lower
    texts = (
        entry.hole,
        fixed(entry.diameter_mm, 2),
        fixed(least_mm, 2),
        "replaced by a later entry" if replaced else _VERDICTS[verdict],
        entry.gauge_id or MISSING,
        entry.source,
        when(entry.time),
    )
    mark = RowMark.NONE if replaced else _MARKS[verdict]
    return TableRow(tuple(TableCell(text) for text in texts), mark)
