"""The pages that an assembly adds to the report of its run."""

from cellctl.processes.deck_to_frame.report.acceptance import acceptance, parts, words
from cellctl.processes.deck_to_frame.report.force_section import force_section, recordings
from cellctl.processes.deck_to_frame.report.gauge_plot import plug_gauges
from cellctl.processes.deck_to_frame.report.gauged_holes import GaugedHole, gauged_holes
from cellctl.processes.deck_to_frame.report.hole_table import TABULATED, hole_blocks
from cellctl.processes.deck_to_frame.report.pass_plot import errors_by_pass
from cellctl.processes.deck_to_frame.report.tiles import tiles
from cellctl.records.entries import RunRecord
from cellctl.records.report.run_sections import GAUGE_VERDICTS, gauge_table, pass_table
from cellctl.records.report.sections import (
    Drawing,
    ProcessPages,
    ReadArtefact,
    RecordPart,
    ReportSection,
    ReportTable,
    TableCell,
    TableRow,
)
from cellctl.records.report.text import fixed

_LOOP_CAPTION = (
    "Error of every component by iteration, with two standard deviations; shaded: within the "
    "threshold. Linear inside the threshold, logarithmic outside. On the right of each title the "
    "last value."
)
_GAUGE_CAPTION = (
    "Largest plug gauge that passes both holes, in steps of 0.01 mm. Shaded: what it may be; the "
    "line is the least."
)


def pages(record: RunRecord, read: ReadArtefact) -> ProcessPages:
    """What the report of an assembly shows besides the pages of any run."""
    curves = recordings(record, read)
    holes = ReportSection("Holes", tuple(hole_blocks(record.measurements)))
    sections = (holes, _loop(record), force_section(record, curves), _pin_holes(record))
    return ProcessPages(
        tiles=tiles(record, curves.values()),
        acceptance=acceptance(record),
        parts=parts(record),
        words=words(record),
        sections=tuple(section for section in sections if section.blocks),
        shows=frozenset({RecordPart.PASSES, RecordPart.GAUGES}),
        tabulated=TABULATED,
    )


def _loop(record: RunRecord) -> ReportSection:
    if not record.passes:
        return ReportSection("", ())
    drawing = Drawing(errors_by_pass(record.passes), _LOOP_CAPTION)
    return ReportSection("Measure and compensate", (drawing, pass_table(record.passes)))


def _pin_holes(record: RunRecord) -> ReportSection:
    if not record.gauges:
        return ReportSection("", ())
    holes = gauged_holes(record)
    drawing = Drawing(plug_gauges(holes), _GAUGE_CAPTION)
    columns = ("hole", "gauge mm", "offset below mm", "verdict", "measured by")
    rows = tuple(_gauge_row(hole) for hole in holes)
    newest = ReportTable(columns, rows, numbers=False)
    return ReportSection("Pin holes", (drawing, newest, gauge_table(record)))


def _gauge_row(hole: GaugedHole) -> TableRow:
    verdict, mark = GAUGE_VERDICTS[hole.verdict]
    texts = (
        hole.gauge.hole,
        fixed(hole.gauge.diameter_mm, 2),
        fixed(hole.offset_below_mm, 2),
        verdict,
        hole.gauge.source,
    )
    return TableRow(tuple(TableCell(text) for text in texts), mark)
