"""The hash chain, which shows what was changed of that which was sealed.

Each entry hashes the content it seals together with the entry before it. What ``problems`` names,
as long as nobody recomputes the hashes: a sealed row that was changed or removed, a row of a sealed
kind that was added, an entry that was changed, removed or added, and, by the head, entries that
were cut off the end. The head, length and newest hash, lies in a table of its own.

What the store alone cannot show, because whoever may write to it can recompute every hash: a chain
that was made anew from some entry on, and a tail that was cut off together with a head set back.
Both show only against a head that lies elsewhere (docs/operating.md, "Whether records were
touched"). Nor can it show what was done to a row before it was sealed: each is sealed in the
transaction that writes it, but what schema 1 and 2 did not seal was sealed by the migration, and
the end of a phase is sealed with its run.

The content of a run depends on the schema that wrote it (``runs.record_schema``): an old run is
sealed and verified over the tables of its own time, which a migration leaves as they are. That
column needs no seal of its own, since with another value the content is another one too.
"""

from collections.abc import Iterable, Iterator
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from cellctl.records.database.schema import Base, LedgerHeadRow, LedgerRow
from cellctl.records.database.sealing.canonical import digest
from cellctl.records.database.sealing.sealed import KINDS, PROGRESS, RUN
from cellctl.records.database.sealing.written_details import WrittenDetails
from cellctl.records.seals import LedgerHead

GENESIS = "0" * 64
_HEAD = 1
_UNREADABLE = "unreadable"
_WORDS = {PROGRESS: "what was written of run"}
Key = int | str


def seal(session: Session, kind: str, row: Base, time: datetime) -> None:
    """Append an entry for a row that was written or changed in this session."""
    session.flush()  # gives a new row its number
    _append(session, kind, getattr(row, KINDS[kind].key), time)


def seal_written(session: Session, run: int, written: WrittenDetails, time: datetime) -> None:
    """Append an entry for details that were written: their running hash, not what is there."""
    _append(session, PROGRESS, run, time, digest(written.hashes))


def is_as_sealed(session: Session, kind: str, subject: int) -> bool:
    """Whether a row is as its newest entry has it."""
    mine = LedgerRow.kind == kind, LedgerRow.subject == subject
    query = select(LedgerRow.content).where(*mine).order_by(LedgerRow.number.desc()).limit(1)
    return (session.scalars(query).first() or "") == _content(session, kind, subject)


def _append(
    session: Session, kind: str, subject: Key, time: datetime, content: str | None = None
) -> None:
    last = session.scalars(select(LedgerRow).order_by(LedgerRow.number.desc()).limit(1)).first()
    number, name = (subject, None) if isinstance(subject, int) else (0, subject)
    row = LedgerRow(
        time=time,
        kind=kind,
        subject=number,
        name=name,
        content=_content(session, kind, subject) if content is None else content,
        previous=last.hash if last else GENESIS,
    )
    row.hash = _entry_hash(row)
    session.add(row)
    session.flush()
    # In the same transaction as the entry: head and chain are on the disk together or not at all.
    session.merge(LedgerHeadRow(id=_HEAD, length=row.number, hash=row.hash))


def head(session: Session) -> LedgerHead:
    """Length and newest hash as they were written down last."""
    row = session.get(LedgerHeadRow, _HEAD)
    return LedgerHead(0, GENESIS) if row is None else LedgerHead(row.length, row.hash)


def holds(session: Session, head: LedgerHead) -> bool:
    """Whether the chain has, or goes on from, a head that it had at some time."""
    row = session.get(LedgerRow, head.length)
    return head == LedgerHead(0, GENESIS) or (row is not None and row.hash == head.hash)


def seal_unsealed(session: Session, time: datetime, kinds: Iterable[str]) -> None:
    """Seal everything of these kinds that is not sealed yet, and write the head down; for stores
    of earlier versions."""
    sealed = {(row.kind, _subject(row)) for row in session.scalars(select(LedgerRow))}
    for kind in kinds:
        for key in _keys(session, kind):
            if (kind, key) not in sealed:
                _append(session, kind, key, time)
    if session.get(LedgerHeadRow, _HEAD) is None:
        last = session.scalars(select(LedgerRow).order_by(LedgerRow.number.desc()).limit(1)).first()
        if last is not None:
            session.merge(LedgerHeadRow(id=_HEAD, length=last.number, hash=last.hash))


def problems(
    session: Session,
    printed: LedgerHead | None = None,
    *,
    is_copy: bool = False,
    more_to_come: bool = False,
) -> Iterator[str]:
    """Every place where the chain does not fit; empty when all is as it was sealed.

    ``printed`` is a head that was printed on a report: the chain must still contain it.
    ``is_copy``: this is a copy, to which the details of a run are brought when it is closed.
    ``more_to_come``: later entries are still to be brought to it, so that a value may be newer or
    older than the last entry that is here.
    """
    rows = session.scalars(select(LedgerRow).order_by(LedgerRow.number)).all()
    yield from _chain(rows)
    newest = {(row.kind, _subject(row)): row.number for row in rows}
    for row in rows:
        subject, kind = _subject(row), KINDS.get(row.kind)
        if kind is None:
            yield f"{_entry(row)} is of an unknown kind"
            continue
        # The value that this entry sealed exists no longer; only the newest one can be compared.
        if kind.superseded and (more_to_come or newest[row.kind, subject] != row.number):
            continue
        is_open = is_copy and row.kind == PROGRESS and not _content(session, RUN, subject)
        if not is_open and row.content != _content(session, row.kind, subject):
            yield f"{_WORDS.get(row.kind, row.kind)} {subject} was changed after it was sealed"
    for name in KINDS:
        for key in _keys(session, name):
            # Also in the other direction: a row that somebody has added with SQL is in no entry of
            # the chain.
            if (name, key) not in newest:
                what = "closed but " if name == RUN else ""
                yield f"{_WORDS.get(name, name)} {key} is {what}not sealed"
    hashes = {row.number: row.hash for row in rows}
    yield from _against(head(session), hashes, "the ledger's head")
    if printed is not None:
        yield from _against(printed, hashes, "the head given")


def _chain(rows: Any) -> Iterator[str]:
    previous = GENESIS
    for row in rows:
        if row.previous != previous:
            yield f"{_entry(row)} does not follow the entry before it"
        if row.hash != _entry_hash(row):
            yield f"{_entry(row)} was changed"
        # Go on from the hash that is written there, so that one change is reported once and not at
        # every later entry.
        previous = row.hash


def _against(head: LedgerHead, hashes: dict[int, str], what: str) -> Iterator[str]:
    found = hashes.get(head.length, GENESIS if not head.length and not hashes else None)
    if found is None:
        yield f"{what} says {head.length} entries, the ledger ends at {max(hashes, default=0)}"
    elif found != head.hash:
        yield f"{what} does not fit entry {head.length}"


def _entry(row: LedgerRow) -> str:
    return f"ledger entry {row.number} ({row.kind} {_subject(row)})"


def _subject(row: LedgerRow) -> Key:
    return row.subject if row.name is None else row.name


def _keys(session: Session, name: str) -> Iterator[Key]:
    """Keys of all rows of which something is to be sealed."""
    kind = KINDS[name]
    for key in session.scalars(select(kind.table.__table__.columns[kind.key])):
        if _content(session, name, key):
            yield key


def _content(session: Session, kind: str, subject: Key) -> str:
    """Hash of what is sealed of a subject; empty where there is nothing to be sealed."""
    try:
        row = KINDS[kind].row(session, subject)
        content = None if row is None else KINDS[kind].content(session, row)
        return "" if content is None else digest(content)
    except (LookupError, TypeError, ValueError):
        # A value that nobody of us has written, such as a verdict that does not exist.
        return _UNREADABLE


def _entry_hash(row: LedgerRow) -> str:
    content: dict[str, Any] = {
        "time": row.time,
        "kind": row.kind,
        "subject": row.subject,
        "content": row.content,
        "previous": row.previous,
    }
    # Entries of schema 1 and 2 have no name, and their hashes were made without one.
    return digest(content if row.name is None else content | {"name": row.name})
