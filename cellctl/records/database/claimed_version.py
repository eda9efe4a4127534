"""Holds the version that a store claims against what is in it.

A migration seals what earlier versions did not seal. A store of today that is made to look old
would have whatever was added to it sealed with the rest.

No version has made a trigger or a view. A trigger changes a row in the transaction that writes it,
before that is sealed: a figure beyond its limit would be read back, judged and sealed as another. A
table does the same by a clause that no version has written: with ``ON CONFLICT IGNORE`` at a
generated column a figure beyond its limit would not be written, and nobody told.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from sqlalchemy import Connection, inspect, text

from cellctl.errors.records.store import StoreContradictsVersion
from cellctl.records.database.sealing.sealed import GAUGE, KINDS, PROGRESS, RUN

_CAME_WITH: dict[int, tuple[tuple[str, str], ...]] = {
    1: (("runs", "number"), ("ledger", "hash")),
    2: (
        ("runs", "record_schema"),
        *((name, "id") for name in ("phases", "figures", "poses", "passes", "documents")),
    ),
    3: (("ledger", "name"), ("gauges", "gauge_id"), ("ledger_head", "length")),
}
"""Columns by the schema that brought them."""
_FOREIGN_CLAUSE = re.compile(r"\b(AS|CHECK|COLLATE|CONFLICT|GENERATED|VIRTUAL)\b", re.IGNORECASE)
"""Words of tables that decide what becomes of a row. No name in the store is one of them."""
_KINDS_BEFORE = {3: frozenset({RUN, GAUGE}), 4: KINDS.keys() - {PROGRESS}, 5: KINDS.keys()}
"""All that earlier schemas than this one have sealed."""


def require_claimed(connection: Connection, file: Path, version: int) -> None:
    """Raise ``StoreContradictsVersion`` when a store holds what its version could not have."""
    found = list(_contradictions(connection, version))
    if found:
        raise StoreContradictsVersion(f"{file} says schema {version} and has {', '.join(found)}")


def foreign_parts(connection: Connection) -> list[str]:
    """Triggers, views and altered tables of a store, in words; empty in every store that nobody has
    altered."""
    query = text("SELECT type, name, sql FROM sqlite_master WHERE type <> 'index'")
    found = []
    for kind, name, sql in connection.execute(query):
        if kind != "table":
            found.append(f"{kind} {name}")
        elif clause := _FOREIGN_CLAUSE.search(sql):
            found.append(f"table {name} with {clause[0].upper()}")
    return found


def require_own_parts(connection: Connection, file: Path) -> None:
    """Raise ``StoreContradictsVersion`` for a trigger, a view or an altered table."""
    if found := foreign_parts(connection):
        raise StoreContradictsVersion(f"{file} has {', '.join(found)}")


def _contradictions(connection: Connection, version: int) -> Iterator[str]:
    yield from foreign_parts(connection)
    tables = inspect(connection)
    has = {
        name: {one["name"] for one in tables.get_columns(name)} for name in tables.get_table_names()
    }
    for schema, columns in _CAME_WITH.items():
        if schema > version:
            yield from (f"{table}.{one}" for table, one in columns if one in has.get(table, ()))
    if version < 1:
        return
    if "record_schema" in has.get("runs", ()):
        later = text("SELECT number FROM runs WHERE record_schema > :version ORDER BY number")
        for number in connection.execute(later, {"version": version}).scalars():
            yield f"run {number} of a later schema"
    kinds = connection.execute(text("SELECT DISTINCT kind FROM ledger ORDER BY kind")).scalars()
    known = next(known for schema, known in _KINDS_BEFORE.items() if version < schema)
    yield from (f"ledger entries of the kind {kind}" for kind in kinds if kind not in known)
