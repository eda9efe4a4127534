"""What the store does to rows inside a transaction."""

import math
from collections.abc import Sequence

from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from cellctl.clock import utc_now
from cellctl.errors.records import RunClosed, RunUnknown
from cellctl.records import ledger
from cellctl.records.entries import RunResult
from cellctl.records.schema import AlarmRow, RunRow


def existing_run(session: Session, number: int) -> RunRow:
    """The row; raises ``RunUnknown``."""
    row = session.get(RunRow, number)
    if row is None:
        raise RunUnknown(str(number))
    return row


def open_run(session: Session, number: int) -> RunRow:
    """The row of a run that may still change; raises ``RunUnknown`` or ``RunClosed``."""
    row = existing_run(session, number)
    if row.ended is not None:
        raise RunClosed(f"run {number}, {row.result}")
    return row


def close(
    session: Session, row: RunRow, result: RunResult, fault_number: int | None, fault: str | None
) -> None:
    """Close a run and seal it."""
    row.ended, row.result = utc_now(), result.value
    row.fault_number, row.fault = fault_number, fault
    session.flush()
    ledger.seal(session, ledger.RUN, row.number, row.ended)


def active_alarm_rows() -> Select[AlarmRow]:
    """Alarms nobody has acknowledged, the oldest first."""
    return select(AlarmRow).where(AlarmRow.acknowledged.is_(None)).order_by(AlarmRow.id)


def floats(values: Sequence[float]) -> list[float | None]:
    """Plain numbers; what is not finite has no place in JSON and becomes null."""
    return [float(value) if math.isfinite(value) else None for value in values]
