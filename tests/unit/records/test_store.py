"""The store: what was written is there, what is closed stays as it was, what fails says so."""

import contextlib
import math
import os
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import cast

import pytest

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.errors.records.store import (
    ArtefactDamaged,
    RecordNotWritten,
    RunClosed,
    RunUnknown,
    StoreInUse,
    StoreUnavailable,
    ValueRefused,
)
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import (
    Document,
    LoopPass,
    PassComponent,
    PoseOrigin,
    RecordedPose,
    Verdict,
)
from cellctl.records.figures import Limit, figure
from tests.unit.records.conftest import start


def files_held_open(folder: Path) -> list[str]:
    """Files below ``folder`` that this process has open, whether or not it still needs them."""
    opened = []
    for descriptor in os.listdir("/proc/self/fd"):
        # The descriptor of this very listing is gone by now.
        with contextlib.suppress(FileNotFoundError):
            opened.append(os.readlink(f"/proc/self/fd/{descriptor}"))
    return [file for file in opened if file.startswith(f"{folder}/")]


SIX = (0.01, -0.02, 0.03, 0.001, -0.002, 0.003)
POSE = RecordedPose("frame", PoseOrigin.MEASURED, "c1", "frame", SIX, SIX, frames=2)
COMPONENT = PassComponent("X", "mm", 0.01, 0.002, 0.05)
CORRECTED = PassComponent("X", "mm", 0.31, 0.002, 0.05, 0.31)


def fill(store: RunStore, run: int) -> None:
    store.begin_phase(run, 10, "measure frame")
    store.add(run, POSE)
    store.begin_phase(run, 40, "correct pose")
    store.add(
        run, LoopPass("loop", 1, (CORRECTED,), False), LoopPass("loop", 2, (COMPONENT,), True)
    )
    store.add_artefact(run, "left.png", b"picture", "image/png")
    store.add(run, figure("speed", 0.25, "mm/s"), figure("peak", 41.5, "N", limit=Limit(upper=50)))
    store.add(run, Document("mating", {"outcome": "none yet", "tries": 1}))
    store.add(run, Document("mating", {"outcome": "seated"}))
    store.add_alarm(run, 501, "F501 something")


def test_a_run_comes_back_as_it_was_written(store: RunStore) -> None:
    run = start(store)
    fill(store, run)
    store.close_run(run, RunResult.GOOD)
    record = store.run(run)
    assert record.head.process == "deck-to-frame"
    assert record.head.serial == "SAT-0001"
    assert record.head.result == "good"
    assert record.head.simulated
    assert record.head.started.tzinfo is UTC
    measure, correct = record.phases
    assert replace(record.measurements[0], phase=None) == POSE
    assert record.poses[0].phase == measure.id
    assert [entry.number for entry in record.passes] == [1, 2]
    assert record.passes[0].components == (CORRECTED,)
    assert record.passes[1].components[0].correction is None
    assert {entry.phase for entry in record.passes} == {correct.id}
    assert (record.value("speed"), record.value("peak"), record.value("depth")) == (
        0.25, 41.5, None,
    )  # fmt: skip
    assert record.newest_figures["peak"].verdict is Verdict.PASS
    assert record.document("mating") == {"outcome": "seated", "tries": 1}
    assert store.artefacts.get(record.artefacts[0].sha256) == b"picture"
    assert record.alarms[0].number == 501
    assert record.seal is not None
    assert store.verify() == []


def test_phases_follow_each_other_and_end_with_the_run(store: RunStore) -> None:
    run = start(store)
    store.begin_phase(run, 10, "measure frame")
    store.begin_phase(run, 20, "measure deck")
    store.begin_phase(run, 10, "measure frame")
    before = store.run(run).phases
    assert [(phase.number, phase.ended is None) for phase in before] == [
        (10, False), (20, False), (10, True),
    ]  # fmt: skip
    assert before[0].ended == before[1].began
    store.close_run(run, RunResult.STOPPED)
    record = store.run(run)
    assert record.phases[-1].ended == record.head.ended


def test_nobody_knows_when_an_interrupted_phase_ended(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    run = start(store)
    store.begin_phase(run, 10, "measure frame")
    store.mark_interrupted()
    assert store.run(run).phases[0].ended is None
    assert store.verify() == []
    store.close()


def test_a_detail_that_cannot_be_written_takes_the_others_of_its_call_back(store: RunStore) -> None:
    run = start(store)
    wrong = replace(figure("speed", 0.25, "mm/s"), unit=cast(str, None))
    with pytest.raises(RecordNotWritten):
        store.add(run, POSE, wrong)
    assert store.run(run).poses == ()


def test_numbers_count_up_and_lists_are_newest_first(store: RunStore) -> None:
    assert [start(store, serial) for serial in ("A", "B", "A")] == [1, 2, 3]
    assert [head.number for head in store.runs()] == [3, 2, 1]
    assert [head.number for head in store.runs(serial="A")] == [3, 1]
    assert [head.number for head in store.runs(limit=1)] == [3]


@pytest.mark.parametrize(
    "change",
    [
        lambda s, n: s.close_run(n, RunResult.GOOD),
        lambda s, n: s.add(n, figure("peak", 1.0, "N")),
        lambda s, n: s.begin_phase(n, 10, "measure frame"),
        lambda s, n: s.add_artefact(n, "x", b"x", "text/plain"),
        fill,
    ],
)
def test_a_closed_run_takes_nothing_more(
    store: RunStore, change: Callable[[RunStore, int], None]
) -> None:
    run = start(store)
    store.close_run(run, RunResult.BAD)
    with pytest.raises(RunClosed):
        change(store, run)
    assert store.verify() == []


def test_a_run_that_does_not_exist_is_named(store: RunStore) -> None:
    with pytest.raises(RunUnknown, match="99"):
        store.run(99)
    with pytest.raises(RunUnknown, match="99"):
        store.close_run(99, RunResult.GOOD)
    with pytest.raises(RunUnknown):
        store.run(10**20)  # more than SQLite can count
    with pytest.raises(RunUnknown):
        store.add_alarm(99, 501, "x")


def test_runs_left_open_are_interrupted_at_the_next_start(tmp_path: Path) -> None:
    first = RunStore(tmp_path)
    run, closed = start(first), start(first)
    first.close_run(closed, RunResult.GOOD)
    first.close()
    second = RunStore(tmp_path)
    assert second.mark_interrupted() == [run]
    assert second.run(run).head.result == "interrupted"
    assert second.run(closed).head.result == "good"
    assert second.mark_interrupted() == []
    assert second.verify() == []
    second.close()


def test_what_was_acknowledged_survives_the_death_of_the_writer(tmp_path: Path) -> None:
    script = """
import os, signal, sys
from pathlib import Path
from cellctl.records import RunStore
from tests.unit.records.conftest import start
store = RunStore(Path(sys.argv[1]))
store.mark_interrupted()
for _ in range(5):
    print(start(store), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""
    root = Path(__file__).parents[3]
    child = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)],
        cwd=root, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert child.returncode == -9
    store = RunStore(tmp_path)
    assert store.mark_interrupted() == [int(line) for line in child.stdout.split()]
    assert len(store.runs()) == 5
    store.close()


def test_two_daemons_do_not_share_a_store(tmp_path: Path) -> None:
    first, second = RunStore(tmp_path), RunStore(tmp_path)
    first.mark_interrupted()
    with pytest.raises(StoreInUse):
        second.mark_interrupted()
    first.close()
    assert second.mark_interrupted() == []
    second.close()


@pytest.mark.parametrize(
    ("statement", "problem"),
    [
        ("UPDATE runs SET result = 'good' WHERE number = 1", "run 1 was changed"),
        ("UPDATE passes SET components = '[]' WHERE id = 1", "run 1 was changed"),
        ("UPDATE figures SET upper = 60 WHERE key = 'peak'", "run 1 was changed"),
        ("UPDATE figures SET verdict = 'fail' WHERE key = 'peak'", "run 1 was changed"),
        ("UPDATE phases SET ended = began", "run 1 was changed"),
        ("UPDATE documents SET content = '{}'", "run 1 was changed"),
        ("DELETE FROM poses", "run 1 was changed"),
        ("UPDATE runs SET record_schema = 1 WHERE number = 1", "run 1 was changed"),
        ("UPDATE gauges SET diameter_mm = 6.0", "gauge 1 was changed"),
        ("DELETE FROM ledger WHERE number = 2", "does not follow"),
        ("UPDATE ledger SET content = previous WHERE kind = 'run' AND subject = 1", "(run 1) was"),
        ("UPDATE runs SET ended = started WHERE number = 3", "run 3 is closed but not sealed"),
    ],
)
def test_tampering_is_found(store: RunStore, statement: str, problem: str) -> None:
    run = start(store)
    fill(store, run)
    store.close_run(run, RunResult.BAD, fault_number=450, fault="F450")
    store.set_gauge(run, "P1", 5.93, "OP-7")
    store.close_run(start(store), RunResult.GOOD)
    start(store)
    assert store.verify() == []
    with sqlite3.connect(store.path / "store.sqlite") as connection:
        connection.execute("PRAGMA foreign_keys = OFF")
        connection.execute(statement)
    connection.close()
    assert any(problem in text for text in store.verify()), store.verify()


def test_gauge_results_may_come_late_and_the_newest_counts(store: RunStore) -> None:
    run = start(store)
    store.close_run(run, RunResult.GOOD)
    store.set_gauge(run, "P1", 5.90, "OP-7")
    store.set_gauge(run, "P1", 5.93, "OP-7")
    store.set_gauge(run, "P5", 5.95, "simulator")
    gauges = {gauge.hole: gauge.diameter_mm for gauge in store.run(run).gauges}
    assert gauges == {"P1": 5.93, "P5": 5.95}
    assert store.verify() == []
    with pytest.raises(ValueRefused):
        store.set_gauge(run, "P1", 593.0, "OP-7")
    with pytest.raises(ValueRefused):
        store.set_gauge(run, "P1", math.nan, "OP-7")
    with pytest.raises(RunUnknown):
        store.set_gauge(99, "P1", 5.9, "OP-7")


def test_alarms_stay_until_acknowledged_over_a_restart(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    store.add_alarm(None, 701, "F701")
    store.add_alarm(None, 701, "F701")
    store.add_alarm(None, 501, "F501")
    store.close()
    store = RunStore(tmp_path)
    assert [alarm.number for alarm in store.active_alarms()] == [701, 701, 501]
    assert store.acknowledge_alarms(701, "OP-7") == 2
    assert store.acknowledge_alarms(701, "OP-7") == 0
    assert [alarm.number for alarm in store.active_alarms()] == [501]
    store.close()


def test_a_calibration_is_kept_once(store: RunStore) -> None:
    now = datetime.now(UTC)
    stored = StoredCalibration(
        "head_1", {"verdict": "pass", "rms_px": 0.03}, now, now + timedelta(days=1), "cellctl", "S1"
    )
    store.add_calibration(stored)
    store.add_calibration(stored)
    assert [entry.id for entry in store.calibrations()] == [stored.id]


def test_the_lines_last_number_is_remembered(store: RunStore) -> None:
    assert store.line_seq() is None
    store.note_line_seq(7)
    store.note_line_seq(8)
    assert store.line_seq() == 8


def test_what_is_not_finite_becomes_unknown(store: RunStore) -> None:
    run = start(store)
    store.add(run, replace(POSE, sigma_mm_deg=(math.nan,) * 6, residual_um=math.inf))
    store.add(run, replace(POSE, detail={"holes": {"P1": [1.0, math.nan]}}))
    store.add(run, figure("peak", math.nan, "N", limit=Limit(upper=50.0)))
    record = store.run(run)
    assert record.poses[0].sigma_mm_deg == (None,) * 6
    assert record.poses[1].detail == {"holes": {"P1": (1.0, None)}}
    assert record.value("peak") is None
    assert record.newest_figures["peak"].verdict is Verdict.FAIL


def test_the_same_bytes_are_stored_once_and_damage_is_found(store: RunStore) -> None:
    run = start(store)
    sha256 = store.add_artefact(run, "a", b"bytes", "text/plain")
    assert store.add_artefact(run, "b", b"bytes", "text/plain") == sha256
    store.artefacts.path(sha256).write_bytes(b"bites")
    with pytest.raises(ArtefactDamaged, match="does not match"):
        store.artefacts.get(sha256)
    store.artefacts.path(sha256).unlink()
    with pytest.raises(ArtefactDamaged, match="No such file"):
        store.artefacts.get(sha256)


def test_a_full_disk_is_a_fault_and_nothing_is_retried(store: RunStore) -> None:
    start(store)
    with store._database.write() as session:
        connection = session.connection().connection.driver_connection
        pages = connection.execute("PRAGMA page_count").fetchone()[0]  # type: ignore[union-attr]
    connection.execute(f"PRAGMA max_page_count = {pages}")  # type: ignore[union-attr]
    with pytest.raises(RecordNotWritten, match="full"):
        store.audit("test", "fill", {"text": "x" * 100_000})
    connection.execute("PRAGMA max_page_count = 1000000")  # type: ignore[union-attr]
    with pytest.raises(RecordNotWritten, match="failed earlier"):
        store.audit("test", "again")
    assert len(store.runs()) == 1


def test_commits_are_durable_and_the_journal_is_wal(store: RunStore) -> None:
    with store._database.read() as session:
        connection = session.connection()
        assert connection.exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
        assert connection.exec_driver_sql("PRAGMA synchronous").scalar() == 2
        assert connection.exec_driver_sql("PRAGMA foreign_keys").scalar() == 1


def test_a_store_that_cannot_be_opened_is_a_clear_fault(tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable, match="there is no"):
        RunStore(tmp_path / "nowhere", create=False)
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(StoreUnavailable):
        RunStore(tmp_path / "file")
    (tmp_path / "store.sqlite").write_bytes(b"this is not a database" * 100)
    with pytest.raises(StoreUnavailable, match="not a database"):
        RunStore(tmp_path)
    assert files_held_open(tmp_path) == []


def test_a_store_of_a_later_version_is_left_alone(tmp_path: Path) -> None:
    RunStore(tmp_path).close()
    with sqlite3.connect(tmp_path / "store.sqlite") as connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(StoreUnavailable, match=r"F810 .*schema 99"):
        RunStore(tmp_path)
    assert files_held_open(tmp_path) == []
    assert not list(tmp_path.glob("*schema*"))
