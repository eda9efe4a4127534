"""What the report shows, worked out from the record; the template only places it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cellctl.records.entered.gauges import part_verdict
from cellctl.records.entered.notes import notes_of
from cellctl.records.entered.said_by import gauge_entries
from cellctl.records.entries import (
    DRY_RUN,
    PRODUCTION,
    Alarm,
    AuditEntry,
    Calibration,
    Figure,
    RunRecord,
    RunResult,
    Verdict,
)
from cellctl.records.parts import TOLD
from cellctl.records.report import run_sections
from cellctl.records.report.acceptance.devices import devices
from cellctl.records.report.acceptance.faults import (
    AlarmLine,
    FaultBox,
    alarm_lines,
    fault_box,
)
from cellctl.records.report.acceptance.identification import identification
from cellctl.records.report.acceptance.runs_before import RunBefore
from cellctl.records.report.acceptance.table import acceptance
from cellctl.records.report.acceptance.timeline import during, timeline
from cellctl.records.report.calibration_view import (
    CalibrationLine,
    HeadLine,
    PoseLine,
    calibration_lines,
    head_lines,
    pose_lines,
)
from cellctl.records.report.images import raw_images, rims
from cellctl.records.report.pictures import PictureGroup, picture_groups
from cellctl.records.report.sections import ProcessPages, ReportSection, Tile
from cellctl.records.report.text import quantity
from cellctl.records.seals import LedgerHead

MOST_TILES = 6
"""Most tiles of a page: two rows of a printed one."""
_VERDICTS = {
    RunResult.GOOD: ("Good part", "good"),
    RunResult.BAD: ("Bad part", "bad"),
    RunResult.STOPPED: ("Stopped", "bad"),
    RunResult.ABORTED: ("Aborted", "bad"),
    RunResult.INTERRUPTED: ("Interrupted", "bad"),
}


@dataclass(frozen=True, slots=True)
class ReportSources:
    """What a report needs besides the record of its run."""

    calibrations: Mapping[str, Calibration]
    """Calibrations of the store, by identity."""
    audit: Sequence[AuditEntry]
    """The audit log of the store, oldest first."""
    ledger_head: LedgerHead
    """End of the store's hash chain when the report is made."""
    cell: Mapping[str, Any]
    """The cell file that the run was made with; empty where the run has none."""
    addresses: Mapping[str, str]
    """Addresses of the pictures, by the names of their files."""
    before: Sequence[RunBefore] = ()
    """Earlier runs of the same part."""
    cell_alarms: Sequence[Alarm] = ()
    """Alarms of no run that came or stood while this one lasted."""


@dataclass(frozen=True, slots=True)
class ReportView:
    """Everything that the template needs."""

    record: RunRecord
    title: str
    """What kind of record it is."""
    verdict: str
    verdict_class: str
    fault: FaultBox | None
    tiles: tuple[Tile, ...]
    before_signatures: tuple[ReportSection, ...]
    """What has to fit on the first page, with the signatures."""
    after_signatures: tuple[ReportSection, ...]
    calibrations: tuple[CalibrationLine, ...]
    heads: tuple[HeadLine, ...]
    poses: tuple[PoseLine, ...]
    after_calibration: tuple[ReportSection, ...]
    pictures: tuple[PictureGroup, ...]
    alarms: tuple[AlarmLine, ...]
    ledger_head: LedgerHead
    """End of the store's hash chain when the report was made."""


def build_view(record: RunRecord, pages: ProcessPages, sources: ReportSources) -> ReportView:
    """What the process brings and what any run has, in the order of the report."""
    verdict, verdict_class = _verdict(record)
    stored, audit = sources.calibrations, during(record, sources.audit)
    notes = notes_of(record.head.number, sources.audit)
    gauges = gauge_entries(record.head.number, sources.audit)
    # A calibration that the run names but that this store does not hold is listed all the same, in
    # ``calibration_lines``.
    used = [stored[i] for i in record.head.calibration_ids.values() if i in stored]
    return ReportView(
        record=record,
        title="Acceptance record" if _of_production(record) else f"Record · {record.head.mode}",
        verdict=verdict,
        verdict_class=verdict_class,
        fault=fault_box(record, audit),
        tiles=pages.tiles or _tiles(record),
        before_signatures=_filled(
            identification(record.head, pages.parts, audit, notes, sources.before),
            acceptance(record, pages.acceptance),
        ),
        after_signatures=_filled(timeline(record, audit, notes, gauges, sources.cell_alarms)),
        calibrations=tuple(calibration_lines(record.head.calibration_ids, stored)),
        heads=tuple(head_lines(used)),
        poses=tuple(pose_lines(used)),
        after_calibration=_filled(
            devices(sources.cell, record.document(TOLD)),
            run_sections.poses(record, pages.tabulated),
            run_sections.fits(record),
            *pages.sections,
            *run_sections.unless_shown(record, pages.shows),
            run_sections.further_figures(record, pages.words, pages.documents),
            rims(record),
            raw_images(record),
        ),
        pictures=picture_groups(sources.addresses),
        alarms=alarm_lines(record),
        ledger_head=sources.ledger_head,
    )


def _verdict(record: RunRecord) -> tuple[str, str]:
    """Words and class of the badge: how the run ended, or what the measuring room found."""
    result = record.head.result
    if result is None:
        return "Not closed", "bad"
    # The measuring room has the last word on a part that its run called good.
    if part_verdict(record) != result:
        return "Bad part by gauge", "bad"
    if record.head.mode == DRY_RUN and result == RunResult.BAD:
        return "Dry run, no part", "good"
    if result == RunResult.GOOD and not _of_production(record):
        return "Passed", "good"
    return _VERDICTS[RunResult(result)]


def _of_production(record: RunRecord) -> bool:
    """Whether a part was made, and not something taught or measured with it."""
    return record.head.mode == PRODUCTION


def _filled(*sections: ReportSection) -> tuple[ReportSection, ...]:
    return tuple(section for section in sections if section.blocks)


def _tiles(record: RunRecord) -> tuple[Tile, ...]:
    judged = [entry for entry in record.newest_figures.values() if entry.verdict is not None]
    return tuple(_tile(entry) for entry in judged[:MOST_TILES])


def _tile(entry: Figure) -> Tile:
    bounds = [
        f"{words} {quantity(bound, entry.unit)}"
        for words, bound in (("at least", entry.lower), ("at most", entry.upper))
        if bound is not None
    ]
    passed = entry.verdict is Verdict.PASS
    return Tile(entry.label, quantity(entry.value, entry.unit), ", ".join(bounds), passed)
