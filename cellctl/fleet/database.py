"""PostgreSQL as the fleet needs it: time limits, numbered faults, one schema for each cell."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from sqlalchemy import URL, Connection, Engine, create_engine, event, text
from sqlalchemy.exc import DBAPIError, NoSuchModuleError, SQLAlchemyError
from sqlalchemy.orm import Session

from cellctl.errors.records.fleet import (
    FleetDiffers,
    FleetError,
    FleetNotInstalled,
    FleetRefused,
    FleetUnreachable,
    RecordUndeliverable,
)


@dataclass(frozen=True, slots=True)
class FleetTimeLimits:
    """How long a program waits for the server."""

    connect_s: int = 10
    statement_s: float = 60.0
    """Longest time of one statement, told to the server, which then ends it."""
    silence_s: float = 20.0
    """Longest wait for a sign of life from the other end of the connection, told to the kernel."""


TIME_LIMITS = FleetTimeLimits()
_REFUSED = ("28", "3D", "3F", "42")
"""Classes of SQLSTATE: login, database, schema, rights and missing tables."""
_NO_TABLE, _REGISTRY = "42P01", "fleet.cells"
"""The table that `cellctl fleet init` makes first."""
_DIFFERS, _NOT_KEPT = "23", "22"


class FleetDatabase:
    """Sessions on the fleet database. Used from one thread at a time."""

    def __init__(self, url: URL, limits: FleetTimeLimits = TIME_LIMITS) -> None:
        """Connects with the first transaction. Raises ``FleetNotInstalled``."""
        try:
            self._engine = _engine(url, limits)
        except (ModuleNotFoundError, NoSuchModuleError) as error:
            raise FleetNotInstalled(str(error)) from error

    def close(self) -> None:
        """Drop the connection."""
        self._engine.dispose()

    @contextmanager
    def transaction(self, place: str | None = None) -> Iterator[Connection]:
        """What the block does is in the database when it ends, or nothing of it.

        ``place`` is the PostgreSQL schema of a cell, in which tables are then looked up. Raises
        the 83x faults.
        """
        try:
            with self._engine.begin() as connection:
                enter(connection, place)
                yield connection
        except SQLAlchemyError as error:
            raise fault_of(error) from error

    @contextmanager
    def view(self, place: str | None = None) -> Iterator[Session]:
        """One unchanging view for reading; raises the 83x faults."""
        engine = self._engine.execution_options(isolation_level="REPEATABLE READ")
        try:
            with engine.begin() as connection, Session(connection) as session:
                connection.execute(text("SET TRANSACTION READ ONLY"))
                enter(connection, place)
                yield session
        except SQLAlchemyError as error:
            raise fault_of(error) from error


def enter(connection: Connection, place: str | None) -> None:
    """Tables of a cell are named without their schema, as in the cell's own store.

    Until the end of the transaction only: nothing that comes later can land in another cell.
    """
    if place is not None:
        connection.execute(text("SELECT set_config('search_path', :place, true)"), {"place": place})


def fault_of(error: SQLAlchemyError) -> FleetError:
    """The numbered fault; statements and their values, which may be long, are left out."""
    if not isinstance(error, DBAPIError):
        return FleetUnreachable(str(error))
    reason = " ".join(str(error.orig).split())
    # A connection that broke, or that was never made, has no state of SQL.
    state = getattr(error.orig, "sqlstate", None) or ""
    if state == _NO_TABLE and _REGISTRY in reason:
        return FleetRefused(f"{reason}; `cellctl fleet init` was never run on it")
    if state.startswith(_REFUSED):
        return FleetRefused(reason)
    if state.startswith(_DIFFERS):
        return FleetDiffers(reason)
    # psycopg refuses some values before the server sees them, without a state.
    if state.startswith(_NOT_KEPT) or _is_refused_value(error):
        return RecordUndeliverable(reason)
    return FleetUnreachable(reason)


def _is_refused_value(error: DBAPIError) -> bool:
    import psycopg

    return isinstance(error.orig, psycopg.DataError)


def _engine(url: URL, limits: FleetTimeLimits) -> Engine:
    engine = create_engine(
        url,
        pool_size=1,
        max_overflow=0,
        # A connection that broke since the last transaction is made anew before the next one.
        pool_pre_ping=True,
        connect_args={
            "connect_timeout": limits.connect_s,
            "application_name": "cellctl",
            # From a database that names no encoding the driver would give texts as bytes.
            "client_encoding": "utf8",
            # A server that has lost its power says nothing: without these a read waits for ever.
            "keepalives_idle": max(1, round(limits.silence_s / 2)),
            "keepalives_interval": max(1, round(limits.silence_s / 4)),
            "keepalives_count": 2,
            "tcp_user_timeout": round(limits.silence_s * 1e3),
        },
    )

    @event.listens_for(engine, "begin")
    def _limits(connection: Connection) -> None:
        limit_ms = round(limits.statement_s * 1e3)
        connection.exec_driver_sql(f"SET LOCAL statement_timeout = {limit_ms}")

    return engine
