"""What was written of an open run is named when somebody changes it before the run is closed."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy.exc import StatementError

from cellctl.errors.records.store import RecordAltered
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import Document, RunDetail
from cellctl.records.figures import Limit, figure
from cellctl.records.files.motion_file import MotionWriter
from cellctl.records.files.unfinished import MOTION
from tests.rigs.sweeps import sweep
from tests.unit.records.conftest import start

ALTERED = "what was written of run 1 was changed after it was sealed"
EDITS = [
    "UPDATE figures SET value = 0.01 WHERE key = 'offset'",
    "UPDATE figures SET verdict = 'pass' WHERE key = 'offset'",
    "UPDATE phases SET label = 'x' WHERE number = 10",
    "UPDATE documents SET content = '{}'",
    "UPDATE artefacts SET sha256 = 'x'",
    "DELETE FROM figures WHERE key = 'offset'",
    "DELETE FROM documents",
    "INSERT INTO figures (run, time, phase, key, label, value, unit) SELECT run, time, phase,"
    " 'forged', label, value, unit FROM figures WHERE key = 'force'",
]


def execute(folder: Path, statement: str) -> None:
    with closing(sqlite3.connect(folder / "store.sqlite")) as connection:
        assert connection.execute(statement).rowcount > 0
        connection.commit()


def details() -> list[RunDetail]:
    return [
        figure("offset", 0.3, "mm", limit=Limit(upper=0.2)),
        figure("force", 36, "N"),
        Document("mating", {"reason": "seated", "figures": (1, 2.0)}),
    ]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    """With an open run, of which something has been written."""
    store = RunStore(tmp_path / "store")
    store.mark_interrupted()
    run = start(store)
    store.begin_phase(run, 10, "measure frame")
    store.add(run, *details())
    store.add_artefact(run, "cell.toml", b"[cell]", "application/toml")
    yield store
    store.close()


def go_on(store: RunStore) -> None:
    store.begin_phase(1, 20, "measure deck")
    store.add(1)
    store.add(1, figure("later", 1.0, "mm"))


def test_a_run_that_nobody_changes_is_good(store: RunStore) -> None:
    assert store.verify() == []
    go_on(store)
    assert store.verify() == []
    store.close_run(1, RunResult.GOOD)
    assert store.run(1).head.result == RunResult.GOOD
    assert store.verify() == []


@pytest.mark.parametrize("edit", sweep(EDITS, EDITS[:2]))
def test_an_edit_of_an_open_run_is_named_at_closing_and_ever_after(
    store: RunStore, edit: str
) -> None:
    execute(store.path, edit)
    assert ALTERED in store.verify()
    go_on(store)
    with pytest.raises(RecordAltered, match="run 1"):
        store.close_run(1, RunResult.GOOD)
    head = store.run(1).head
    assert (head.result, head.fault_number) == (RunResult.BAD, RecordAltered.number)
    assert ALTERED in store.verify()


def test_an_edit_of_the_opening_is_named_at_closing(store: RunStore) -> None:
    execute(store.path, "UPDATE runs SET serial = 'SAT-0009'")
    with pytest.raises(RecordAltered):
        store.close_run(1, RunResult.GOOD)
    assert store.verify() == ["opening 1 was changed after it was sealed"]


def test_a_run_that_is_not_good_keeps_its_own_end(store: RunStore) -> None:
    execute(store.path, EDITS[0])
    with pytest.raises(RecordAltered):
        store.close_run(1, RunResult.ABORTED, fault_number=525, fault="F525")
    head = store.run(1).head
    assert (head.result, head.fault_number) == (RunResult.ABORTED, 525)


def test_what_holds_against_a_ledger_that_was_made_anew_is_the_memory_of_the_writer(
    store: RunStore,
) -> None:
    execute(store.path, EDITS[0])
    execute(store.path, "DELETE FROM ledger WHERE kind = 'progress'")
    with pytest.raises(RecordAltered):
        store.close_run(1, RunResult.GOOD)


def test_an_interrupted_run_that_was_changed_before_the_next_start(store: RunStore) -> None:
    with store.open_recording(1) as file:
        writer = MotionWriter(file, datetime.now(UTC), 0.0)
        felt_n = np.random.default_rng(1).normal(0.0, 10.0, (20_000, 6))
        writer.force("force", np.arange(20_000) / 1000, felt_n)
        writer.flush()
    store.close()
    execute(store.path, EDITS[0])
    later = RunStore(store.path)
    assert later.mark_interrupted() == [1]
    assert later.verify() == [ALTERED]
    assert MOTION in [one.name for one in later.run(1).artefacts]
    later.close()


def test_an_interrupted_run_that_nobody_changed(store: RunStore) -> None:
    store.close()
    later = RunStore(store.path)
    later.add(1, figure("later", 1.0, "mm"))
    assert later.mark_interrupted() == [1]
    assert later.verify() == []
    later.close()


def test_a_write_that_was_refused_leaves_no_trace(store: RunStore) -> None:
    with pytest.raises(StatementError):
        store.add(1, figure("f", 1.0, "mm"), Document("d", {"x": object()}))
    go_on(store)
    store.close_run(1, RunResult.GOOD)
    assert store.verify() == []
