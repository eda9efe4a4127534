"""Details of an open run, sealed as they are written."""

from collections.abc import Sequence

from sqlalchemy.orm import Session

from cellctl.clock import utc_now
from cellctl.records.database.schema import Base, RunRow
from cellctl.records.database.sealing import ledger
from cellctl.records.database.sealing.sealed import OPENING, PROGRESS
from cellctl.records.database.sealing.written_details import WrittenDetails


def altered(session: Session, row: RunRow, written: WrittenDetails) -> bool:
    """Whether an open run is another one than was written."""
    opened = ledger.is_as_sealed(session, OPENING, row.number)
    return not opened or WrittenDetails.read(session, row.number) != written


def add_details(
    session: Session, row: RunRow, new: Sequence[Base], written: WrittenDetails | None
) -> WrittenDetails | None:
    """Add details to an open run and seal what is written of it by then, which is returned.

    ``written`` is what was written before; None where an earlier owner has. What is there counts
    then, unless it is not what that owner has sealed: the seal that shows it stays the newest, and
    None is returned.
    """
    if written is None and row.record_schema >= 4:
        intact = ledger.is_as_sealed(session, PROGRESS, row.number)
        written = WrittenDetails.read(session, row.number) if intact else None
    session.add_all(new)
    if written is None or not new:
        return written
    written = written.and_then(session, new)
    ledger.seal_written(session, row.number, written, utc_now())
    return written
