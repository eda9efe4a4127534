"""A store of schema 1, as its own code wrote it, opens without loss."""

import json
import re
import shutil
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import create_engine
from typer.testing import CliRunner

from cellctl.cli.records.runs import app
from cellctl.errors.records.store import StoreUnavailable
from cellctl.records import RunResult, RunStore
from cellctl.records.database import migration
from cellctl.records.database.schema import Base
from cellctl.records.database.schema_version import FILE, SCHEMA_VERSION
from cellctl.records.entries import LoopPass, PoseOrigin
from cellctl.records.figures import figure
from cellctl.records.report.export import export_run
from tests.unit.records.conftest import start
from tests.unit.records.page import read

OLD = Path(__file__).parents[3] / "data" / "store-v1"
RUNS = (1, 2, 3, 4, 5)
LOST = "F202 Connection to a device lost: aux_1: no answer"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """A copy of the store of schema 1, never opened."""
    folder = tmp_path / "old"
    shutil.copytree(OLD, folder, ignore=shutil.ignore_patterns("expected"))
    return folder


@pytest.fixture
def store(old: Path) -> Iterator[RunStore]:
    store = RunStore(old, create=False)
    yield store
    store.close()


@pytest.fixture(scope="module")
def migrated(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunStore]:
    """Migrated once for all tests that only read."""
    folder = tmp_path_factory.mktemp("migrated") / "old"
    shutil.copytree(OLD, folder, ignore=shutil.ignore_patterns("expected"))
    store = RunStore(folder, create=False)
    yield store
    store.close()


def expected(run: int) -> dict[str, Any]:
    """``run.json`` as schema 1 exported it."""
    path = OLD / "expected" / f"run-{run}" / "run.json"
    document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return document


def execute(folder: Path, statement: str) -> None:
    with sqlite3.connect(folder / "store.sqlite") as connection:
        connection.execute(statement)
    connection.close()


def version(folder: Path) -> int:
    with sqlite3.connect(folder / "store.sqlite") as connection:
        number: int = connection.execute("PRAGMA user_version").fetchone()[0]
    connection.close()
    return number


@pytest.mark.parametrize("number", RUNS)
def test_head_alarms_gauges_files_and_seal_are_as_they_were(
    migrated: RunStore, number: int
) -> None:
    old, record = expected(number), migrated.run(number)
    for name in ("serial", "mode", "result", "fault", "operator", "calibration_ids", "simulated"):
        assert getattr(record.head, name) == old[name], name
    assert record.head.process == "deck-to-frame"
    assert record.head.started == datetime.fromisoformat(old["started"])
    for name, fields in (
        ("alarms", ("number", "text", "acknowledged_by")),
        ("gauges", ("hole", "diameter_mm", "source")),
        ("artefacts", ("name", "sha256", "size", "media_type")),
    ):
        entries = getattr(record, name)
        assert [[getattr(entry, field) for field in fields] for entry in entries] == [
            [entry[field] for field in fields] for entry in old[name]
        ]
    seal = None if record.seal is None else (record.seal.content, record.seal.hash)
    assert seal == (old["seal"] and (old["seal"]["content"], old["seal"]["hash"]))


@pytest.mark.parametrize("number", RUNS)
def test_measurements_are_poses(migrated: RunStore, number: int) -> None:
    old, record = expected(number), migrated.run(number)
    assert len(record.poses) == len(old["measurements"]) > 0
    for pose, was in zip(record.poses, old["measurements"], strict=True):
        assert (pose.key, pose.origin) == (was["kind"], PoseOrigin.MEASURED)
        for name in ("pose_mm_deg", "sigma_mm_deg", "residual_um", "frames", "detail"):
            assert plain(getattr(pose, name)) == was[name], name
        assert pose.time == datetime.fromisoformat(was["time"])
    frames = {pose.key: f"{pose.parent}_T_{pose.child}" for pose in record.poses}
    assert frames["frame"] == "c1_T_frame"
    assert number == 5 or frames["flange_T_deck"] == "flange_T_deck"


@pytest.mark.parametrize("number", RUNS)
def test_iterations_are_passes(migrated: RunStore, number: int) -> None:
    old, record = expected(number)["iterations"], migrated.run(number)
    assert len(old) == (2 if number <= 3 else 0)
    assert [iteration_of(entry) for entry in record.passes] == old


def iteration_of(entry: LoopPass) -> dict[str, Any]:
    """A pass as schema 1 wrote it."""
    corrections = [component.correction for component in entry.components]
    return {
        "time": entry.time.isoformat(),
        "iteration": entry.number,
        "error_mm_deg": [component.value for component in entry.components],
        "sigma_mm_deg": [component.sigma for component in entry.components],
        "threshold_mm_deg": [component.limit for component in entry.components],
        "frames": entry.frames,
        "residual_um": entry.residual_um,
        "converged": entry.converged,
        "correction_mm_deg": [] if corrections == [None] * 6 else corrections,
    }


@pytest.mark.parametrize("number", RUNS)
def test_the_mating_is_figures_and_a_document(migrated: RunStore, number: int) -> None:
    old, record = expected(number)["mating"] or {}, migrated.run(number)
    leaves = dict(leaves_of(old))
    assert bool(leaves) == (number <= 3)
    numbers = {path: value for path, value in leaves.items() if isinstance(value, float | int)}
    error = leaves.get(("seated_error_mm_deg",), [])
    found = [entry.value for entry in record.figures if entry.value is not None]
    assert len(found) == len(record.figures)
    assert sorted(found) == sorted([*numbers.values(), *error]), "every number is a figure, once"
    texts = {path: value for path, value in leaves.items() if path not in numbers}
    texts.pop(("seated_error_mm_deg",), None)
    assert dict(leaves_of(plain(record.document("mating")))) == texts


@pytest.mark.parametrize(
    ("key", "unit", "path"),
    [
        ("approach.speed", "mm/s", ("approach", "speed_mm_s")),
        ("approach.stiffness", "N/mm", ("approach", "stiffness_n_per_mm")),
        ("window.latest", "mm", ("window", "latest_mm")),
        ("limit_force", "N", ("limit_force_n",)),
        ("peak_force", "N", ("peak_force_n",)),
        ("peak_moment", "N·m", ("peak_moment_n_m",)),
        ("creep_steps", "", ("creep_steps",)),
        ("gave_way.yaw", "°", ("gave_way", "yaw_deg")),
        ("pin_offsets.P5", "mm", ("pin_offsets_mm", "P5")),
    ],
)
def test_figures_have_their_keys_and_units(
    migrated: RunStore, key: str, unit: str, path: tuple[str, ...]
) -> None:
    found = migrated.run(1).newest_figures[key]
    assert found.unit == unit
    assert found.value == dict(leaves_of(expected(1)["mating"]))[path]


def leaves_of(
    document: Mapping[str, Any], path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], Any]]:
    for key, value in document.items():
        if isinstance(value, dict):
            yield from leaves_of(value, (*path, key))
        else:
            yield (*path, key), value


def plain(value: object) -> Any:
    return json.loads(json.dumps(value))


@pytest.mark.parametrize(
    ("statement", "problem"),
    [
        ("UPDATE runs SET result = 'good' WHERE number = 2", "run 2 was changed"),
        ("UPDATE gauges SET diameter_mm = 6.0 WHERE id = 2", "gauge 2 was changed"),
        ("DELETE FROM ledger WHERE number = 2", "does not follow"),
        *(
            pytest.param(*one, marks=pytest.mark.figures)
            for one in (
                ("UPDATE runs SET process = 'another' WHERE number = 2", "run 2 was changed"),
                ("UPDATE runs SET record_schema = 2 WHERE number = 2", "run 2 was changed"),
                ("UPDATE runs SET mating = '{}' WHERE number = 1", "run 1 was changed"),
                ("UPDATE iterations SET converged = 1 WHERE id = 1", "run 1 was changed"),
                ("DELETE FROM measurements WHERE run = 3", "run 3 was changed"),
                ("UPDATE artefacts SET name = 'x' WHERE run = 3", "run 3 was changed"),
            )
        ),
    ],
)
def test_a_change_in_an_old_row_is_found(
    store: RunStore, old: Path, statement: str, problem: str
) -> None:
    assert store.verify() == []
    execute(old, statement)
    assert any(problem in text for text in store.verify()), store.verify()


def test_the_run_that_was_left_open_is_closed_and_sealed(store: RunStore) -> None:
    assert store.mark_interrupted() == [5]
    assert store.run(5).head.result == "interrupted"
    assert store.verify() == []


def test_new_runs_follow_the_old_ones(store: RunStore, old: Path) -> None:
    run = start(store)
    store.begin_phase(run, 10, "measure frame")
    store.add(run, figure("peak", 41.5, "N"))
    store.close_run(run, RunResult.GOOD)
    store.set_gauge(1, "P5", 5.96, "OP-7")
    assert run == 6
    assert store.run(run).value("peak") == 41.5
    assert store.run(1).gauges[-1].diameter_mm == 5.96
    assert store.verify() == []
    execute(old, "UPDATE figures SET value = 1.0")
    assert store.verify() == [
        "what was written of run 6 was changed after it was sealed",
        "run 6 was changed after it was sealed",
    ]


def test_everything_else_is_still_there(migrated: RunStore) -> None:
    assert [entry.actor for entry in migrated.audit_log()] == ["OP-7"] * 3
    assert migrated.line_seq() == 41
    assert [alarm.text for alarm in migrated.active_alarms()] == [LOST]
    invalidated = [entry for entry in migrated.calibrations() if entry.invalidated is not None]
    assert [entry.invalidated_reason for entry in invalidated] == ["collision"]


def test_the_store_is_backed_up_before_it_is_changed(old: Path) -> None:
    before = dump(old / "store.sqlite")
    RunStore(old, create=False).close()
    assert version(old) == SCHEMA_VERSION
    backup = old / "store-schema-1.sqlite"
    assert dump(backup) == before
    assert not list(old.glob("*.part"))
    made = backup.stat().st_mtime_ns
    RunStore(old).close()
    assert backup.stat().st_mtime_ns == made, "once is enough"


def dump(file: Path) -> list[str]:
    with sqlite3.connect(file) as connection:
        lines = list(connection.iterdump())
        lines.append(str(connection.execute("PRAGMA user_version").fetchone()))
    connection.close()
    return lines


def test_a_backup_can_be_put_back_with_a_plain_copy(old: Path) -> None:
    RunStore(old).close()
    for name in ("store.sqlite-wal", "store.sqlite-shm"):
        (old / name).unlink(missing_ok=True)
    shutil.copy(old / "store-schema-1.sqlite", old / "store.sqlite")
    store = RunStore(old)
    assert store.verify() == []
    store.close()


def test_what_is_still_in_the_log_of_the_old_store_is_backed_up_too(old: Path) -> None:
    daemon = sqlite3.connect(old / "store.sqlite")  # holds the log open, as a daemon would
    daemon.execute("UPDATE persistent_values SET value = 42")
    daemon.commit()
    RunStore(old).close()
    daemon.close()
    backup = sqlite3.connect(old / "store-schema-1.sqlite")
    assert backup.execute("SELECT value FROM persistent_values").fetchall() == [(42,)]
    backup.close()


def test_a_migration_that_fails_changes_nothing(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = dump(old / "store.sqlite")

    def fail(_connection: object) -> None:
        raise sqlite3.OperationalError("disk I/O error")

    monkeypatch.setattr(migration, "_STEPS", (*migration._STEPS, fail))
    with pytest.raises(StoreUnavailable, match="disk I/O error"):
        RunStore(old)
    assert dump(old / "store.sqlite") == before
    monkeypatch.undo()
    store = RunStore(old)
    assert store.verify() == []
    store.close()


def test_a_store_that_cannot_be_backed_up_is_not_migrated(old: Path) -> None:
    (old / "store-schema-1.sqlite.part").mkdir()
    with pytest.raises(StoreUnavailable, match="directory"):
        RunStore(old)
    assert version(old) == 1


def test_a_daemon_of_the_earlier_version_goes_on_with_a_migrated_store(old: Path) -> None:
    """It has the store open while an operator's command of this version migrates it."""
    daemon = sqlite3.connect(old / "store.sqlite")
    assert daemon.execute("SELECT count(*) FROM runs").fetchone() == (5,)
    reader = RunStore(old, create=False)
    columns = ", ".join(expected_columns())
    daemon.execute(f"INSERT INTO runs ({columns}) SELECT {columns} FROM runs WHERE number = 1")
    daemon.execute("UPDATE runs SET ended = NULL, result = NULL WHERE number = 6")
    daemon.execute(
        "INSERT INTO measurements (run, time, kind, pose_mm_deg, sigma_mm_deg, frames, detail)"
        " SELECT 6, time, kind, pose_mm_deg, sigma_mm_deg, frames, detail FROM measurements"
        " WHERE run = 1"
    )
    daemon.commit()
    record = reader.run(6)
    assert (record.head.process, record.head.record_schema) == ("deck-to-frame", 1)
    assert len(record.measurements) == 4
    reader.close()
    daemon.close()
    owner = RunStore(old)
    assert owner.mark_interrupted() == [5, 6]
    assert owner.verify() == []
    owner.close()


def expected_columns() -> list[str]:
    """Columns of a run that schema 1 wrote, without its number."""
    # Immutable: SQLite would otherwise write its log beside the file, which belongs to the tests.
    connection = sqlite3.connect(f"file:{OLD / 'store.sqlite'}?immutable=1", uri=True)
    rows = connection.execute("PRAGMA table_info(runs)").fetchall()
    connection.close()
    return [row[1] for row in rows if row[1] != "number"]


def test_commands_open_an_old_store(old: Path, tmp_path: Path) -> None:
    runner = CliRunner(env={"COLUMNS": "140", "NO_COLOR": "1"})
    where = ["--data-dir", str(old)]
    listed = runner.invoke(app, ["list", *where])
    assert listed.exit_code == 0
    assert re.search(r"2\s+SAT-0002 \(sim\).*bad", listed.stdout)
    shown = runner.invoke(app, ["show", "1", *where])
    assert "-0.6028".replace("-", "−") in shown.stdout
    assert "gauge 5.93 mm (OP-7)" in shown.stdout
    out = tmp_path / "out"
    assert runner.invoke(app, ["export", "1", "--out", str(out), *where]).exit_code == 0
    assert json.loads((out / "run.json").read_text(encoding="utf-8"))["record_schema"] == 1
    verified = runner.invoke(app, ["verify", *where])
    assert (verified.exit_code, verified.stdout) == (0, "all closed runs are as they were sealed\n")


@pytest.mark.parametrize("number", RUNS)
def test_an_old_run_has_a_report_without_its_process(
    store: RunStore, tmp_path: Path, number: int
) -> None:
    text = " ".join(read(export_run(store, number, tmp_path)).texts)
    assert "deck-to-frame" in text
    assert ("approach: speed" in text) == (number <= 3)


def test_a_new_store_has_the_tables_and_indexes_of_the_schema(tmp_path: Path) -> None:
    RunStore(tmp_path / "new").close()
    engine = create_engine(f"sqlite:///{tmp_path / 'drawn.sqlite'}")
    Base.metadata.create_all(engine)
    engine.dispose()
    drawn = made_in(tmp_path / "drawn.sqlite")
    assert len(drawn) > 20
    assert made_in(tmp_path / "new" / FILE) == drawn


def made_in(file: Path) -> list[tuple[str, str, str]]:
    """Kind, name and words of all that a database is made of."""
    with closing(sqlite3.connect(file)) as connection:
        rows = connection.execute("SELECT type, name, sql FROM sqlite_master")
        return sorted((kind, name, str(sql)) for kind, name, sql in rows)
