"""Questions to a store of years: 10 000 runs, and as many alarms and commands."""

import sqlite3
import time
from contextlib import closing
from pathlib import Path

import pytest

from cellctl.records.database.schema_version import FILE
from tests.unit.hmi.in_process import Api, settings_for
from tests.unit.hmi.routes.conftest import NEW, fill

RUNS = 10_000


@pytest.fixture(scope="module")
def years(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("years")
    fill(folder)
    numbers = [(f"PART-{n}",) for n in range(RUNS)]
    with closing(sqlite3.connect(folder / FILE)) as database, database:
        for table, key, changed in (("runs", "number", "serial"), ("alarms", "id", "text")):
            columns = [row[1] for row in database.execute(f"PRAGMA table_info({table})")]
            columns.remove(key)
            values = ", ".join("?" if name == changed else name for name in columns)
            copy = f"INSERT INTO {table} ({', '.join(columns)}) SELECT {values} FROM {table}"
            # The second alarm is one of no run.
            database.executemany(f"{copy} WHERE {key} = 2", numbers)
        command = "INSERT INTO audit (time, actor, action, detail)"
        command += " SELECT time, actor, action, json_set(detail, '$.key', ?) FROM audit LIMIT 1"
        database.executemany(command, numbers)
    return folder


@pytest.mark.parametrize(
    ("path", "limit_s"),
    [
        ("runs?serial=PART-77", 0.2),
        (f"recall/calibrations/{NEW.id}", 1.0),
        ("recall/serials/DECK-1", 1.0),
        ("alarms?active=true", 0.2),
        ("commands/key-refused-1", 1.0),
    ],
)
async def test_what_is_asked_is_answered_in_time(years: Path, path: str, limit_s: float) -> None:
    api = Api(settings_for(years))
    await api.hear()
    assert (await api.get(path)).status == 200, "whatever has to be loaded is loaded now"
    # Of the processor and not of the clock: other tests run beside this one.
    begin_s = time.process_time()
    reply = await api.get(path)
    spent_s = time.process_time() - begin_s
    assert reply.status == 200
    assert spent_s < limit_s
