"""Who entered something: the user that the system knows, beside the name that somebody typed.

The actor of an audit entry is a user of the PC, a person at the page, or the line with its address.
A name that was typed stands beside it, as what was said: whoever types can type any name.
"""

from collections.abc import Sequence

from cellctl.records.entries import AuditEntry, Gauge

BY = "by"
"""Key in the detail of an entry: the name that was typed."""
GAUGE = "gauge"
"""Action of the audit log."""
ENTERED = "entered"
"""Key in the detail of a gauge's entry: the time of the gauge, by which it is found."""


ORDER = "order"
"""Key in the detail of a command: the order that its giver has named."""
REFUSED = "refused"
"""Key in the detail of a command that was not obeyed: why."""


def was_obeyed(entry: AuditEntry) -> bool:
    """False for a command that was refused, which has led to nothing."""
    return REFUSED not in entry.detail


def said_by(entry: AuditEntry) -> str:
    """Who has said it, as ``Anna, typed by terminal:root``; in entries of earlier versions a typed
    name stands alone."""
    typed = entry.detail.get(BY)
    return f"{typed}, typed by {entry.actor}" if typed else entry.actor


def gauge_entries(run: int, audit: Sequence[AuditEntry]) -> tuple[AuditEntry, ...]:
    """What the audit log says of the gauges of one run; ``audit`` is the whole log."""
    return tuple(one for one in audit if one.action == GAUGE and one.detail.get("run") == run)


def measured_by(gauge: Gauge, entries: Sequence[AuditEntry]) -> str:
    """Who measured, and who typed it where that is recorded; ``entries`` are those of the run."""
    entered = gauge.time.isoformat()
    found = next((one for one in entries if one.detail.get(ENTERED) == entered), None)
    return gauge.source if found is None else said_by(found)
