"""What the report shows, worked out from the record; the template only places it."""

from collections.abc import Mapping
from dataclasses import dataclass

from cellctl.records.entries import Calibration, Figure, RunRecord, RunResult, Verdict
from cellctl.records.gauges import part_verdict
from cellctl.records.report import run_sections
from cellctl.records.report.calibration_view import (
    CalibrationLine,
    HeadLine,
    PoseLine,
    calibration_lines,
    head_lines,
    pose_lines,
)
from cellctl.records.report.pictures import PictureGroup, picture_groups
from cellctl.records.report.sections import ProcessPages, ReportSection, Tile
from cellctl.records.report.text import quantity
from cellctl.records.seals import LedgerHead

MOST_TILES = 6
"""As many as fit into two rows of a printed page."""
_VERDICTS = {
    RunResult.GOOD: ("Good part", "good"),
    RunResult.BAD: ("Bad part", "bad"),
    RunResult.STOPPED: ("Stopped", "bad"),
    RunResult.ABORTED: ("Aborted", "bad"),
    RunResult.INTERRUPTED: ("Interrupted", "bad"),
}


@dataclass(frozen=True, slots=True)
class ReportView:
    """Everything that the template needs."""

    record: RunRecord
    verdict: str
    verdict_class: str
    tiles: tuple[Tile, ...]
    before_calibration: tuple[ReportSection, ...]
    calibrations: tuple[CalibrationLine, ...]
    heads: tuple[HeadLine, ...]
    poses: tuple[PoseLine, ...]
    after_calibration: tuple[ReportSection, ...]
    pictures: tuple[PictureGroup, ...]
    ledger_head: LedgerHead
    """Of the store when the report was made."""


def build_view(
    record: RunRecord,
    calibrations: Mapping[str, Calibration],
    pages: ProcessPages,
    addresses: Mapping[str, str],
    ledger_head: LedgerHead,
) -> ReportView:
    """Calibrations by identity, what the process brings, and addresses of pictures by name."""
    verdict, verdict_class = _verdict(record)
    # A calibration that the run names but that this store does not hold is listed all the same, in
    # ``calibration_lines``.
    used = [calibrations[i] for i in record.head.calibration_ids.values() if i in calibrations]
    return ReportView(
        record=record,
        verdict=verdict,
        verdict_class=verdict_class,
        tiles=pages.tiles or _tiles(record),
        before_calibration=_filled(
            run_sections.judged_figures(record), run_sections.phases(record)
        ),
        calibrations=tuple(calibration_lines(record.head.calibration_ids, calibrations)),
        heads=tuple(head_lines(used)),
        poses=tuple(pose_lines(used)),
        after_calibration=_filled(
            run_sections.poses(record, pages.tabulated),
            *pages.sections,
            *run_sections.unless_shown(record, pages.shows),
            run_sections.further_figures(record),
        ),
        pictures=picture_groups(addresses),
        ledger_head=ledger_head,
    )


def _verdict(record: RunRecord) -> tuple[str, str]:
    """Words and class of the badge: how the run ended, or what the measuring room found."""
    result = record.head.result
    if result is None:
        return "Not closed", "bad"
    # The measuring room has the last word on a part that its run called good.
    if part_verdict(record) != result:
        return "Bad part: plug gauge beyond its limit", "bad"
    return _VERDICTS[RunResult(result)]


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
