"""What happened in a run, in the order of time, and who did it."""

from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime, timedelta
from typing import Any

from cellctl.records.entered.notes import NOTE, note_words
from cellctl.records.entered.said_by import BY, GAUGE, measured_by, said_by, was_obeyed
from cellctl.records.entries import Alarm, AuditEntry, RunRecord
from cellctl.records.procedure_entries import MADE_BY_PROCEDURES
from cellctl.records.report.sections import Note, ReportSection, ReportTable, TableCell, TableRow
from cellctl.records.report.text import MISSING, duration, facts, fixed, when

_BEFORE = timedelta(seconds=30)
"""The command that starts a run is written down before its record is opened, which may wait as long
as this for the disk."""
_CELL = "cell"
_OWN_LINE = frozenset({GAUGE, NOTE})
"""Entries of the audit log that have a line of their own, with more in it."""
Event = tuple[datetime, str, str]
"""Time, what happened, who did it."""


def during(record: RunRecord, audit: Sequence[AuditEntry]) -> tuple[AuditEntry, ...]:
    """Entries of the audit log from the start command of a run to its end."""
    begin, end = record.head.started - _BEFORE, record.head.ended
    within = [
        entry for entry in audit if begin <= entry.time and (end is None or entry.time <= end)
    ]
    # The last start is that of this run, since nothing is started while it lasts; what was
    # commanded before that belongs to another one.
    starts = [
        index for index, one in enumerate(within) if one.action == "start" and was_obeyed(one)
    ]
    return tuple(within[starts[-1] :] if starts else within)


def timeline(
    record: RunRecord,
    audit: Sequence[AuditEntry],
    notes: Sequence[AuditEntry] = (),
    gauges: Sequence[AuditEntry] = (),
    cell_alarms: Sequence[Alarm] = (),
) -> ReportSection:
    """Commands, steps, alarms, gauges and notes as one table; ``audit`` is that of the run's time,
    ``notes`` and ``gauges`` are those on the run, also later ones, ``cell_alarms`` are of no run
    and came or stood in its time."""
    found = (*_events(record, audit, notes, gauges), *_of_the_cell(record, cell_alarms))
    events = sorted(found, key=lambda event: event[0])
    rows = tuple(
        TableRow((TableCell(when(time)), TableCell(what), TableCell(who or MISSING)))
        for time, what, who in events
    )
    table = ReportTable(("time", "what", "who"), rows, numbers=False)
    note = Note("The line PLC is named by its network address, people at the terminal and on the "
                "operator page as they have signed in. A name that was typed stands beside the "
                "user who typed it.")  # fmt: skip
    return ReportSection("Timeline", (table, note))


def _events(
    record: RunRecord,
    audit: Sequence[AuditEntry],
    notes: Sequence[AuditEntry],
    gauges: Sequence[AuditEntry],
) -> Iterator[Event]:
    head = record.head
    for entry in audit:
        if entry.action not in _OWN_LINE:
            command = "" if entry.action in MADE_BY_PROCEDURES else "command "
            yield entry.time, f"{command}{entry.action}{_details(entry.detail)}", said_by(entry)
    yield head.started, "record opened", _CELL
    for phase in record.phases:
        lasted = duration(phase.began, phase.ended)
        yield phase.began, f"step {phase.number}, {phase.label}: {lasted}", _CELL
    for alarm in record.alarms:
        yield alarm.time, f"alarm {alarm.text}", _CELL
        if alarm.acknowledged is not None:
            what = f"alarm F{alarm.number:03d} acknowledged"
            yield alarm.acknowledged, what, alarm.acknowledged_by or ""
    if head.ended is not None:
        yield head.ended, f"run closed: {head.result}", _CELL
    for entry in notes:
        yield entry.time, f"note: {note_words(entry)}", said_by(entry)
    for gauge in record.gauge_history:
        what = f"plug gauge {gauge.gauge_id or ''} through {gauge.hole}: "
        yield gauge.time, f"{what}{fixed(gauge.diameter_mm, 2)} mm", measured_by(gauge, gauges)


def _of_the_cell(record: RunRecord, alarms: Sequence[Alarm]) -> Iterator[Event]:
    """Alarms that belong to no run, such as a lost line, in their order with those of the run."""
    begin, end = record.head.started, record.head.ended
    for alarm in alarms:
        stood = ", not acknowledged when the run began" if alarm.time < begin else ""
        yield alarm.time, f"alarm {alarm.text} (of the cell{stood})", _CELL
        ended = alarm.acknowledged
        if ended is not None and begin <= ended and (end is None or ended <= end):
            what = f"alarm F{alarm.number:03d} acknowledged"
            yield ended, what, alarm.acknowledged_by or ""


def _details(detail: Mapping[str, Any]) -> str:
    said = {name: value for name, value in detail.items() if name != BY}
    texts = [f"{name} {value}" for name, value in facts(said) if value not in ("", MISSING)]
    return f" ({', '.join(texts)})" if texts else ""
