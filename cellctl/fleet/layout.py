"""The tables of the fleet database, and who may do what with them; for its administrator.

A cell's forwarder adds rows to its own cell and fills what is still empty, as the end of a run. The
server refuses it everything else: whoever takes over a cell's PC can change no record that has been
delivered, and reads no other cell's.
"""

import re
from collections.abc import Iterable

from sqlalchemy import Column, Connection, MetaData, Table, inspect, select, text, update
from sqlalchemy.dialects import postgresql
from sqlalchemy.schema import CreateSchema

from cellctl.errors.records.fleet import FleetDiffers, FleetRefused
from cellctl.fleet.database import FleetDatabase, enter
from cellctl.fleet.tables import FLEET, CellRow, FleetBase, PlaceBase, table_of
from cellctl.records.database.schema import Base
from cellctl.records.database.schema_1.tables import BaseOfSchema1
from cellctl.records.database.schema_version import SCHEMA_VERSION

READERS = "cellctl_fleet_reader"
"""Role whose members may read all records; the administrator grants it."""
_MATING = "mating"
_ONCE = {
    "runs": "OLD.ended IS NOT NULL",
    "alarms": "OLD.acknowledged IS NOT NULL",
    "calibrations": "OLD.invalidated IS NOT NULL",
    "ledger_head": "NEW.length < OLD.length",
}
"""Condition on which a change of a row of this table is refused, also to the cell itself."""
_FORWARDER = (
    "INSERT ON ALL TABLES IN SCHEMA {place}",
    "SELECT (number, hash) ON {place}.ledger",
    "SELECT (number, ended, result, fault_number, fault, mating),"
    " UPDATE (ended, result, fault_number, fault, mating) ON {place}.runs",
    "SELECT (id, acknowledged, acknowledged_by),"
    " UPDATE (acknowledged, acknowledged_by) ON {place}.alarms",
    "SELECT (id, invalidated, invalidated_reason),"
    " UPDATE (invalidated, invalidated_reason) ON {place}.calibrations",
    "SELECT, UPDATE (value) ON {place}.persistent_values",
    "SELECT, UPDATE (length, hash) ON {place}.ledger_head",
    "SELECT, UPDATE (length, sent, received, software) ON {place}.delivery",
)


def create(fleet: FleetDatabase) -> None:
    """Make the database one of a fleet; again is no change. Raises the 83x faults."""
    with fleet.transaction() as connection:
        connection.execute(CreateSchema(FLEET, if_not_exists=True))
        FleetBase.metadata.create_all(connection)
        connection.execute(
            text(
                f"CREATE OR REPLACE FUNCTION {FLEET}.refuse_change() RETURNS trigger"
                " LANGUAGE plpgsql AS $$ BEGIN RAISE EXCEPTION"
                " '% keeps what is recorded', TG_TABLE_NAME"
                " USING ERRCODE = 'integrity_constraint_violation'; END $$"
            )
        )
        if (
            connection.execute(
                text("SELECT 1 FROM pg_roles WHERE rolname = :name"), {"name": READERS}
            ).first()
            is None
        ):
            connection.execute(text(f"CREATE ROLE {READERS} NOLOGIN"))
        _grant(connection, (f"USAGE ON SCHEMA {FLEET}", f"SELECT ON {FLEET}.cells"), READERS)


def add_cell(fleet: FleetDatabase, name: str, forwarder: str) -> str:
    """Take the records of a cell, which the role ``forwarder`` brings; its PostgreSQL schema.

    Again, also with another role, is no change of what is there. Raises the 83x faults.
    """
    with fleet.transaction() as connection:
        place = connection.execute(select(CellRow.place).where(CellRow.name == name)).scalar()
        if place is None:
            place = _free_place(connection, name)
            connection.execute(CreateSchema(place))
            _create_tables(connection, place)
            row = {"name": name, "place": place, "record_schema": SCHEMA_VERSION}
            connection.execute(table_of(CellRow).insert(), row)
        _grant_cell(connection, place, forwarder)
    return place


def migrate(fleet: FleetDatabase) -> list[str]:
    """Bring the tables of all cells to today's version; the names of the cells that had older ones.

    A new version of a run store only adds tables and columns, so cells of earlier versions go on
    delivering. Raises ``FleetDiffers`` for tables of a later version, and the other 83x faults.
    """
    with fleet.transaction() as connection:
        found = connection.execute(select(table_of(CellRow))).all()
        later = [row.name for row in found if row.record_schema > SCHEMA_VERSION]
        if later:
            raise FleetDiffers(f"tables of a later version: {', '.join(later)}")
        older = [row for row in found if row.record_schema < SCHEMA_VERSION]
        for row in older:
            enter(connection, row.place)
            _create_tables(connection, row.place)
            for forwarder in _forwarders(connection, row.place):
                _grant_cell(connection, row.place, forwarder)
        connection.execute(update(CellRow).values(record_schema=SCHEMA_VERSION))
    return [row.name for row in older]


def _free_place(connection: Connection, name: str) -> str:
    """A readable name for PostgreSQL, which allows 63 bytes, that no other cell has."""
    base = "cell_" + re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:40]
    taken = set(connection.execute(select(CellRow.place)).scalars())
    numbered = (f"{base}_{number}" for number in range(2, len(taken) + 3))
    return next(place for place in (base, *numbered) if place not in taken)


def _create_tables(connection: Connection, place: str) -> None:
    """Everything that is not there yet."""
    enter(connection, place)
    for metadata in _tables():
        metadata.create_all(connection)
        _add_columns(connection, metadata.tables.values())
    for table, condition in _ONCE.items():
        connection.execute(
            text(
                f"CREATE OR REPLACE TRIGGER filled_once BEFORE UPDATE ON {table} FOR EACH ROW"
                f" WHEN ({condition}) EXECUTE FUNCTION {FLEET}.refuse_change()"
            )
        )


def _tables() -> tuple[MetaData, ...]:
    """Those of a run store of any version, and our own.

    The order matters: ``runs`` of schema 1 is that of today with a column more.
    """
    return Base.metadata, BaseOfSchema1.metadata, PlaceBase.metadata


def _add_columns(connection: Connection, tables: Iterable[Table]) -> None:
    for table in tables:
        present = {column["name"] for column in inspect(connection).get_columns(table.name)}
        for column in table.columns:
            if column.name not in present:
                kind = _type(column)
                connection.execute(
                    text(f"ALTER TABLE {table.name} ADD COLUMN {column.name} {kind}")
                )


def _type(column: Column[object]) -> str:
    """Without NOT NULL: rows of earlier versions have nothing in a column that came later."""
    return column.type.compile(dialect=postgresql.dialect())  # type: ignore[no-untyped-call]


def _forwarders(connection: Connection, place: str) -> list[str]:
    query = "SELECT DISTINCT grantee FROM information_schema.table_privileges WHERE "
    query += "table_schema = :place AND table_name = 'ledger' AND privilege_type = 'INSERT'"
    query += " AND grantee <> current_user"
    return list(connection.execute(text(query), {"place": place}).scalars())


def _grant_cell(connection: Connection, place: str, forwarder: str) -> None:
    if (
        connection.execute(
            text("SELECT 1 FROM pg_roles WHERE rolname = :name"), {"name": forwarder}
        ).first()
        is None
    ):
        raise FleetRefused(f"there is no role {forwarder!r}: CREATE ROLE … LOGIN PASSWORD …")
    reads = (f"USAGE ON SCHEMA {place}", f"SELECT ON ALL TABLES IN SCHEMA {place}")
    _grant(connection, reads, READERS)
    own = (f"USAGE ON SCHEMA {FLEET}", f"USAGE ON SCHEMA {place}", f"SELECT ON {FLEET}.cells")
    _grant(connection, (*own, *(right.format(place=place) for right in _FORWARDER)), forwarder)


def _grant(connection: Connection, rights: Iterable[str], role: str) -> None:
    quoted = postgresql.dialect().identifier_preparer.quote_identifier(role)  # type: ignore[no-untyped-call]
    for right in rights:
        connection.execute(text(f"GRANT {right} TO {quoted}"))
