"""The list of runs, read by SQLite alone.

The database layer of the store takes longer to load than a list takes to be read, and an operator
looks at the list often.
"""

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import asdict, dataclass, fields
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from cellctl.errors.records.store import StoreUnavailable
from cellctl.records.database.missing_store import missing_store
from cellctl.records.database.read_access import ReadAccess
from cellctl.records.database.schema_version import FILE, SCHEMA_VERSION
from cellctl.records.entered.gauges import (
    GAUGE_HOLES,
    PART_VERDICT,
    beyond_limit,
    hole_limits,
    with_gauges,
)
from cellctl.records.entries import RunHead, RunResult
from cellctl.records.run_filter import RunFilter

ALL = RunFilter()
_BUSY_TIMEOUT_S = 5.0
"""Longest wait for a daemon that is writing, as in ``database.sessions``."""
_COLUMNS = tuple(field.name for field in fields(RunHead))
_TIMES, _JSON, _TRUTHS = frozenset({"started", "ended"}), "calibration_ids", "simulated"
"""Columns that SQLite keeps as text or number, see ``column_types.py``."""


@dataclass(frozen=True, slots=True)
class ListedRun:
    """A run, and what plug gauges have made of it since it was closed."""

    head: RunHead
    spoilt: bool
    """A gauge has turned its good part into a bad one."""

    def for_programs(self) -> dict[str, Any]:
        """The head as plain data, with the verdict on the part."""
        return asdict(self.head) | {PART_VERDICT: with_gauges(self.head.result, spoilt=self.spoilt)}


def listed_runs(folder: Path, limit: int, wanted: RunFilter = ALL) -> list[ListedRun]:
    """The newest of the wanted runs of the store in a folder, newest first.

    A store of an earlier version is migrated first. Raises ``StoreUnavailable``, ``StoreTooNew``.
    """
    file = folder / FILE
    # SQLite would make an empty one.
    if not file.exists():
        raise missing_store(file)
    found = _read(file, limit, wanted)
    if found is None:
        from cellctl.records.store import RunStore

        RunStore(folder, create=False).close()
        found = _read(file, limit, wanted)
    if found is None:
        raise StoreUnavailable(f"{file} was not migrated")
    return found


def _read(file: Path, limit: int, wanted: RunFilter) -> list[ListedRun] | None:
    """The runs of one file; None for a store of another version."""
    access = ReadAccess(file)
    try:
        with closing(access.connect(_BUSY_TIMEOUT_S)) as connection:
            connection.row_factory = sqlite3.Row
            # One view: a gauge may be entered between the queries.
            connection.execute("BEGIN")
            (version,) = connection.execute("PRAGMA user_version").fetchone()
            if version != SCHEMA_VERSION:
                return None
            heads = [_head(row) for row in _rows(connection, limit, wanted)]
            good = [head.number for head in heads if head.result == RunResult.GOOD]
            spoilt = set(_spoilt(connection, good))
    except sqlite3.Error as error:
        raise StoreUnavailable(f"{file}: {error}") from error
    access.check()
    return [ListedRun(head, head.number in spoilt) for head in heads]


def _rows(connection: sqlite3.Connection, limit: int, wanted: RunFilter) -> list[sqlite3.Row]:
    condition, values = wanted.sql()
    query = f"SELECT {', '.join(_COLUMNS)} FROM runs WHERE {condition}"
    query += " ORDER BY number DESC LIMIT :limit"
    return connection.execute(query, values | {"limit": limit}).fetchall()


def _head(row: sqlite3.Row) -> RunHead:
    return RunHead(**{name: _value(name, row[name]) for name in _COLUMNS})


def _value(name: str, kept: Any) -> Any:
    if kept is None:
        return None
    if name in _TIMES:
        return datetime.fromisoformat(kept).replace(tzinfo=UTC)
    if name == _JSON:
        return json.loads(kept)
    return bool(kept) if name == _TRUTHS else kept


def _spoilt(connection: sqlite3.Connection, runs: Iterable[int]) -> Iterator[int]:
    """Those whose newest gauge of some hole is beyond its limit."""
    for run in runs:
        gauges = connection.execute(
            "SELECT hole, diameter_mm FROM gauges WHERE run = ? ORDER BY id", (run,)
        )
        newest: Mapping[str, float] = {row["hole"]: row["diameter_mm"] for row in gauges}
        if newest and beyond_limit(hole_limits(_holes(connection, run)), newest):
            yield run


def _holes(connection: sqlite3.Connection, run: int) -> Mapping[str, Any]:
    """All documents of the run that name its holes, as one; later entries replace earlier ones."""
    query = "SELECT content FROM documents WHERE run = ? AND key = ? ORDER BY id"
    holes: dict[str, Any] = {}
    for row in connection.execute(query, (run, GAUGE_HOLES)):
        holes |= json.loads(row["content"])
    return holes
