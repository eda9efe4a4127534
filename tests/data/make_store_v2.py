"""How `store-v2` was made, with the code of the version that wrote schema 2; not for today's.

Run at that version, from the root: `python -m tests.data.make_store_v2 tests/data/store-v2`.
"""

import json
import sqlite3
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from cellctl.records import RunResult, RunStore
from tests.unit.records import sample
from tests.unit.records.conftest import start


def make(folder: Path) -> None:
    """Two closed runs, one that is open, gauges, alarms, calibrations, audit lines."""
    store = RunStore(folder)
    good = sample.good_run(store)
    bad = start(store, "SAT-0002")
    store.add_alarm(bad, 525, "F525 Side load too high while mating: 27.0 N")
    store.add_alarm(None, 202, "F202 Connection to a device lost: aux_1: no answer")
    store.close_run(bad, RunResult.ABORTED, fault_number=525, fault="F525")
    store.acknowledge_alarms(525, "OP-7")
    store.audit("OP-7", "start", {"run": good})
    store.audit("line", "abort")
    store.note_line_seq(41)
    start(store, "SAT-0003")
    records = [asdict(store.run(number)) for number in (1, 2, 3)]
    assert store.verify() == []
    store.close()
    with sqlite3.connect(folder / "store.sqlite") as connection:
        connection.execute("PRAGMA journal_mode = DELETE")
    connection.close()
    (folder / "owner.lock").unlink(missing_ok=True)
    text = json.dumps(records, indent=1, default=_plain)
    (folder / "expected.json").write_text(text + "\n", encoding="utf-8")


def _plain(value: object) -> Any:
    return str(value)


if __name__ == "__main__":
    make(Path(sys.argv[1]))
