"""SQLite as the store needs it: durable at every commit, one writer, numbered faults.

Measured elsewhere and kept here as rules: WAL with ``synchronous=FULL`` loses no acknowledged
commit in a power cut, NORMAL does; and after a failed fsync the next one may lie, so a store that
failed once takes nothing more until it is opened anew.
"""

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Any

from sqlalchemy import URL, Engine, create_engine, event
from sqlalchemy.exc import DBAPIError, IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from cellctl.errors.records.store import (
    RecordNotWritten,
    RunUnknown,
    StoreLocked,
    StoreTooNew,
    StoreUnavailable,
)
from cellctl.files.atomic_files import make_folder_durably
from cellctl.records.database import migration
from cellctl.records.database.claimed_version import require_own_parts
from cellctl.records.database.missing_store import missing_store
from cellctl.records.database.read_access import ReadAccess
from cellctl.records.database.schema_version import SCHEMA_VERSION

LOCK_WAIT_S = 5.0
"""Longest wait of SQLite for another process that is writing, such as a command that enters a
gauge; a write takes milliseconds."""
_READS = "store_reads"


class Database:
    """Sessions on one file. Used from one thread at a time."""

    def __init__(
        self,
        file: Path,
        *,
        create: bool,
        alone: Callable[[], AbstractContextManager[None]],
        lock_wait_s: float = LOCK_WAIT_S,
    ) -> None:
        """Open, or create if allowed; an older store is migrated (see ``migration``).

        Readers migrate, too: an operator lists the runs of an old store before any daemon opens
        it. ``alone`` keeps every daemon off meanwhile. Raises ``StoreUnavailable``,
        ``StoreTooNew``, ``StoreLocked``, and what ``alone`` raises.
        """
        self._failed: str | None = None
        self._file = file
        if not (create or file.exists()):
            raise missing_store(file)
        self._access = ReadAccess(file)
        self._engine = _engine(file, self._access, lock_wait_s)
        try:
            make_folder_durably(file.parent)
            # A store of today is opened without a write, so without waiting for a writer's lock.
            version = self._version()
            if version != SCHEMA_VERSION:
                # A store without tables is nobody's yet, one of a later version is refused.
                older = 0 < version < SCHEMA_VERSION
                with alone() if older else nullcontext(), self._engine.begin() as connection:
                    migration.bring_up_to_date(connection, file)
        except StoreUnavailable:
            self.close()
            raise
        except (OSError, SQLAlchemyError, sqlite3.Error) as error:
            self.close()
            # Only a store that is created or migrated is written to here.
            fault = StoreLocked if _is_locked(error) else StoreUnavailable
            raise fault(f"{file}: {_reason(error)}") from error

    def _version(self) -> int:
        with self._reader().connect() as connection:
            return migration.schema_version(connection)

    def _reader(self) -> Engine:
        return self._engine.execution_options(**{_READS: True})

    def close(self) -> None:
        """Drop the connection."""
        self._engine.dispose()

    @contextmanager
    def write(self) -> Iterator[Session]:
        """A transaction that is on the disk when the block ends.

        Raises ``RecordNotWritten`` when it is not, and from then on always; ``StoreLocked`` when
        another program was writing all the time, and nothing was written; ``RunUnknown`` when it
        refers to a run that does not exist; ``StoreTooNew`` when a later version has migrated the
        store since it was opened; ``StoreContradictsVersion`` when it has a trigger, a view
        or an altered table.
        """
        if self._failed is not None:
            raise RecordNotWritten(f"the store failed earlier: {self._failed}")
        try:
            with Session(self._engine, expire_on_commit=False) as session, session.begin():
                version = migration.schema_version(session.connection())
                if version != SCHEMA_VERSION:
                    raise StoreTooNew(f"it has schema {version} since it was opened")
                # With the lock held, so that none can be added before this transaction ends.
                require_own_parts(session.connection(), self._file)
                yield session
        # A refused row is a mistake of the caller and says nothing about the disk: the store goes
        # on.
        except IntegrityError as error:
            fault = RunUnknown if "FOREIGN KEY" in _reason(error) else RecordNotWritten
            raise fault(_reason(error)) from error
        except DBAPIError as error:
            # SQLite refuses a transaction under somebody else's lock before it writes a byte, so
            # this says nothing about the disk either.
            if _is_locked(error):
                raise StoreLocked(_reason(error)) from error
            # A second fsync may report success for data that are lost (docs/decisions/0011), so
            # nothing is written until the store has been opened anew.
            self._failed = _reason(error)
            raise RecordNotWritten(self._failed) from error

    @contextmanager
    def read(self) -> Iterator[Session]:
        """A consistent view; raises ``StoreUnavailable``."""
        try:
            with Session(self._reader()) as session:
                yield session
        except DBAPIError as error:
            raise StoreUnavailable(_reason(error)) from error
        self._access.check()


def _engine(file: Path, access: ReadAccess, lock_wait_s: float) -> Engine:
    # Not as a text, in which a question mark of a folder's name ends the path.
    url = URL.create("sqlite", database=str(file))
    engine = create_engine(url, creator=lambda: access.connect(lock_wait_s, one_thread=False))

    @event.listens_for(engine, "connect")
    def _settings(connection: Any, _record: Any) -> None:
        connection.isolation_level = None  # BEGIN is ours, see below
        # FULL, because in WAL mode NORMAL may lose the last commits in a power cut
        # (docs/decisions/0011). Foreign keys are off in SQLite unless they are asked for at every
        # connection.
        for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def _begin(connection: Any) -> None:
        # IMMEDIATE takes the write lock at once: a transaction that reads first and writes later
        # could fail with "database is locked" in its middle, without waiting.
        reads = connection.get_execution_options().get(_READS, False)
        connection.exec_driver_sql("BEGIN" if reads else "BEGIN IMMEDIATE")

    return engine


def _is_locked(error: Exception) -> bool:
    """Whether another connection held the lock; SQLite has several codes for where it met it."""
    code: int = getattr(_cause(error), "sqlite_errorcode", sqlite3.SQLITE_OK)
    # The low byte is the kind of error, the rest says more of it (sqlite.org/rescode.html).
    return code & 0xFF == sqlite3.SQLITE_BUSY


def _reason(error: Exception) -> str:
    return str(_cause(error))


def _cause(error: Exception) -> Exception:
    """The error of SQLite where SQLAlchemy has wrapped it."""
    cause: Exception = getattr(error, "orig", None) or error
    return cause
