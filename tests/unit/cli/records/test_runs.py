"""`cellctl runs`: what an operator sees of the store and enters into it."""

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.os_user import terminal_user
from cellctl.cli.records.runs import app
from cellctl.errors.records.store import RunUnknown, StoreUnavailable
from cellctl.records import RunResult, RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entered.said_by import gauge_entries, measured_by
from cellctl.records.entries import Document
from cellctl.records.figures import KNOWN_TO, Limit, figure
from cellctl.records.required.required_figures import required, required_document
from tests.unit.records.conftest import start
from tests.unit.records.sample import good_run


@pytest.fixture(scope="module")
def two_runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with a good run and one that is open, of which each test has a copy."""
    store = RunStore(tmp_path_factory.mktemp("two") / "runs")
    good_run(store)
    start(store, "SAT-0043")
    store.close()
    return store.path


@pytest.fixture
def store(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[RunStore]:
    # Before it is opened, and only where the test asks for these runs.
    if "folder" in request.fixturenames:
        shutil.copytree(request.getfixturevalue("two_runs"), tmp_path / "runs")
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


@pytest.fixture
def runner() -> CliRunner:
    return CliRunner(env={"COLUMNS": "120", "NO_COLOR": "1"})


@pytest.fixture
def folder(store: RunStore) -> str:
    """Of a store with two runs."""
    return str(store.path)


def test_programs_get_lists_and_runs(runner: CliRunner, folder: str) -> None:
    listed = json.loads(runner.invoke(app, ["list", "--json", "--data-dir", folder]).stdout)
    assert [(one["number"], one["result"]) for one in listed] == [(2, None), (1, "good")]
    shown = json.loads(runner.invoke(app, ["show", "1", "--json", "--data-dir", folder]).stdout)
    assert shown["head"]["serial"] == "SAT-0042"
    assert shown["figures"]


def test_runs_are_listed_newest_first(runner: CliRunner, folder: str) -> None:
    result = runner.invoke(app, ["list", "--data-dir", folder])
    assert result.exit_code == 0
    assert re.search(r"2\s+SAT-0043.*open", result.stdout)
    assert re.search(r"1\s+SAT-0042 \(sim\).*good", result.stdout)
    one = runner.invoke(app, ["list", "--data-dir", folder, "--serial", "SAT-0042"])
    assert "SAT-0043" not in one.stdout


@pytest.mark.parametrize("written", ["207", "F207", "f207"])
def test_a_fault_is_taken_as_people_write_it(runner: CliRunner, folder: str, written: str) -> None:
    done = runner.invoke(app, ["list", "--fault", written, "--data-dir", folder])
    assert (done.exit_code, done.stdout) == (0, "no runs\n")
    assert runner.invoke(app, ["list", "--fault", "two"]).exit_code == 2


def test_a_result_that_no_run_can_have_is_refused(runner: CliRunner) -> None:
    refused = runner.invoke(app, ["list", "--result", "god"])
    assert refused.exit_code == 2
    assert "did you mean 'good'?" in refused.output


def test_one_run_in_figures(runner: CliRunner, folder: str) -> None:
    result = runner.invoke(app, ["show", "1", "--data-dir", folder])
    assert result.exit_code == 0
    assert "+1.2143" in result.stdout
    assert re.search(r"peak force\s+38.4 N\s+–\s+50 N\s+pass", result.stdout)
    assert "gauge 5.95 mm (simulator)" in result.stdout


def test_what_a_run_has_ended_without_is_shown_and_told_to_programs(
    runner: CliRunner, store: RunStore, tmp_path: Path
) -> None:
    run = start(store)
    store.add(run, required_document([required("seat.gap", "mm", Limit(-0.1, 0.1))]))
    asked = [str(run), "--data-dir", str(store.path)]
    open_run = runner.invoke(app, ["show", *asked]).stdout
    assert "not measured" not in open_run
    store.close_run(run, RunResult.ABORTED)
    shown = runner.invoke(app, ["show", *asked]).stdout
    assert re.search(r"seat: gap\s+–\s+-0.1 mm\s+0.1 mm\s+not measured", shown)
    told = [json.loads(runner.invoke(app, ["show", *asked, "--json"]).stdout)]
    runner.invoke(app, ["export", *asked, "--out", str(tmp_path / "out")])
    told.append(json.loads((tmp_path / "out" / "run.json").read_text(encoding="utf-8")))
    missing = {"key": "seat.gap", "label": "seat: gap", "unit": "mm", "lower": -0.1, "upper": 0.1}
    assert [one["not_measured"] for one in told] == [[missing]] * 2


def test_what_ends_a_correction_is_not_called_a_pass(runner: CliRunner, store: RunStore) -> None:
    run = start(store)
    store.add(
        run,
        figure("angle_error", 0.004, "°", limit=Limit(upper=0.006)),
        figure(f"angle_error{KNOWN_TO}", 0.0031, "°"),
    )
    shown = runner.invoke(app, ["show", str(run), "--data-dir", str(store.path)]).stdout
    assert re.search(r"angle error\s+0.004°\s+–\s+0.006°\s+within threshold, as measured", shown)


def test_brackets_in_names_and_serial_numbers_are_shown(runner: CliRunner, store: RunStore) -> None:
    """Rich takes ``[x]`` for mark-up: two parts would have one serial number."""
    run = start(store, "SAT-[a]-7 :100:")
    store.add(run, figure("gap_[x]", 0.1, "mm", limit=Limit(upper=0.2)))
    asked = ("--data-dir", str(store.path))
    assert "SAT-[a]-7 :100:" in runner.invoke(app, ["list", *asked]).stdout
    shown = runner.invoke(app, ["show", str(run), *asked]).stdout
    assert "SAT-[a]-7 :100:" in shown
    assert "gap [x]" in shown


def test_a_run_is_exported(runner: CliRunner, folder: str, tmp_path: Path) -> None:
    out = tmp_path / "handed on"
    result = runner.invoke(app, ["export", "1", "--out", str(out), "--data-dir", folder])
    assert result.exit_code == 0
    assert "Measure and compensate" in (out / "report.html").read_text(encoding="utf-8")


def test_a_run_is_exported_for_foxglove(runner: CliRunner, folder: str, tmp_path: Path) -> None:
    out = tmp_path / "handed on" / "run.mcap"
    options = ["--mcap", "--images", "jpeg", "--out", str(out), "--data-dir", folder]
    result = runner.invoke(app, ["export", "1", *options])
    assert result.exit_code == 0, result.output
    assert out.read_bytes().startswith(b"\x89MCAP0\r\n")
    # The run of the sample has no motion, which whoever asks for it has to know.
    assert "missing: motion.mcap" in result.stderr
    assert re.search(r"run\.mcap: \d+ messages on \d+ topics, \d+\.\d MB", result.stdout)
    layout = json.loads((tmp_path / "handed on" / "run.foxglove.json").read_text(encoding="utf-8"))
    assert "Plot!contact-force" in layout["configById"]


def test_a_gauge_is_entered(runner: CliRunner, folder: str, store: RunStore) -> None:
    options = ["--hole", "P1", "--mm", "5.91", "--source", "OP-7", "--data-dir", folder]
    assert runner.invoke(app, ["gauge", "1", *options]).exit_code == 0
    assert {g.hole: g.diameter_mm for g in store.run(1).gauges}["P1"] == 5.91
    wrong = runner.invoke(app, ["gauge", "9", *options])
    assert isinstance(wrong.exception, RunUnknown)


def test_who_typed_a_gauge_stands_beside_who_is_said_to_have_measured(
    runner: CliRunner, folder: str, store: RunStore, tmp_path: Path
) -> None:
    options = ["--hole", "P1", "--mm", "5.91", "--source", "anna", "--data-dir", folder]
    told = runner.invoke(app, ["gauge", "1", *options])
    anna = f"anna, typed by {terminal_user()}"
    assert f"gauge 5.91 mm ({anna})" in told.stdout
    (entry,) = (one for one in store.audit_log() if one.action == "gauge")
    assert (entry.actor, entry.detail["by"]) == (terminal_user(), "anna")
    assert f"({anna})" in runner.invoke(app, ["show", "1", "--data-dir", folder]).stdout
    runner.invoke(app, ["export", "1", "--out", str(tmp_path / "out"), "--data-dir", folder])
    assert anna in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert store.verify() == []


def test_a_gauge_that_an_earlier_version_entered_shows_its_name_alone(store: RunStore) -> None:
    run = good_run(store)
    store.set_gauge(run, "P1", 5.91, "OP-7")
    store.audit("OP-7", "gauge", {"run": run, "hole": "P1", "diameter_mm": 5.91})
    gauge = store.run(run).gauge_history[-1]
    assert measured_by(gauge, gauge_entries(run, store.audit_log())) == "OP-7"


def test_a_changed_file_is_found(runner: CliRunner, folder: str, store: RunStore) -> None:
    good = runner.invoke(app, ["verify", "--data-dir", folder])
    assert good.exit_code == 0
    store.artefacts.path(store.run(1).artefacts[0].sha256).write_bytes(b"changed")
    bad = runner.invoke(app, ["verify", "--data-dir", folder])
    assert bad.exit_code == 1
    assert "frame-head-1-left.png" in bad.stdout
    told = runner.invoke(app, ["verify", "--json", "--data-dir", folder])
    assert told.exit_code == 1
    plain = json.loads(told.stdout)
    assert plain["problems"] == bad.stdout.splitlines()
    assert plain["ledger_head"] == str(store.ledger_head())


def test_without_a_store_there_is_a_fault_and_none_is_made(
    runner: CliRunner, tmp_path: Path
) -> None:
    result = runner.invoke(app, ["list", "--data-dir", str(tmp_path / "nowhere")])
    assert isinstance(result.exception, StoreUnavailable)
    assert not (tmp_path / "nowhere").exists()


def test_a_note_is_told_and_shown(runner: CliRunner, folder: str) -> None:
    words = ["note", "1", "--by", "anna", "--temperature", "21.3", "--humidity", "45"]
    words += ["--instrument", "TH-3", "--remark", "door was open", "--data-dir", folder]
    told = runner.invoke(app, words)
    assert told.exit_code == 0, told.output
    said = "temperature 21.3 °C, relative humidity 45 %, instrument TH-3, door was open"
    anna = f"anna, typed by {terminal_user()}"
    assert f"run 1: {said} ({anna}, 20" in told.stdout
    assert (
        f"note of {anna}: {said}" in runner.invoke(app, ["show", "1", "--data-dir", folder]).stdout
    )
    shown = json.loads(runner.invoke(app, ["show", "1", "--json", "--data-dir", folder]).stdout)
    assert [note["detail"]["temperature_deg_c"] for note in shown["notes"]] == [21.3]


def test_a_list_in_80_columns_cuts_nothing(runner: CliRunner, folder: str, store: RunStore) -> None:
    start(store, "PROCEDURE-10801", mode="maintenance")
    dry = start(store, "SAT-0042", mode="dry run")
    store.close_run(dry, RunResult.BAD)
    narrow = {"COLUMNS": "80"}
    for words in (["list"], ["show", str(dry)]):
        listed = runner.invoke(app, [*words, "--data-dir", folder], env=narrow).stdout
        assert "…" not in listed
        assert f"{store.run(dry).head.started:%Y-%m-%d %H:%M}" in listed
        assert max(len(line) for line in listed.splitlines()) <= 80
    assert (
        "PROCEDURE-10801" in runner.invoke(app, ["list", "--data-dir", folder], env=narrow).stdout
    )


def test_a_serial_number_is_never_broken(runner: CliRunner, folder: str, store: RunStore) -> None:
    """Also not beside the longest result, nor one of the 24 characters that it may have."""
    gauged = start(store, "SAT-0042")
    store.add(gauged, Document(GAUGE_HOLES, {"P1": {"least_mm": 5.9, "most_mm": 6.0}}))
    store.close_run(gauged, RunResult.GOOD)
    store.set_gauge(gauged, "P1", 5.85, "OP-7")
    longest = "SAT-0042-REPAIRED-TWICE7"
    for serial in ("", longest):
        if serial:
            start(store, serial)
        words = ["list", "--data-dir", folder]
        listed = runner.invoke(app, words, env={"COLUMNS": "80"}).stdout
        head, *_ = listed.splitlines()
        assert head.split() == [
            "run", "serial", "recipe", "mode", "started", "(UTC)", "duration", "result",
        ]  # fmt: skip
        assert max(len(line) for line in listed.splitlines()) <= 80
        assert "SAT-0042 " in listed
        assert serial in listed
        assert "…" not in listed
    wide = runner.invoke(app, ["list", "--data-dir", folder], env={"COLUMNS": "160"}).stdout
    assert "SAT-0042 (sim)" in wide
    assert "good, bad by gauge" in wide


def test_a_run_that_a_command_ended_shows_by_whom_and_where(
    runner: CliRunner, folder: str, store: RunStore
) -> None:
    store.audit("terminal:lin", "start", {"serial": "SAT-0044"})
    run = start(store, "SAT-0044")
    store.begin_phase(run, 50, "mate")
    store.audit("terminal:wei", "abort", {})
    store.close_run(run, RunResult.ABORTED)
    shown = runner.invoke(app, ["show", str(run), "--data-dir", folder]).stdout
    said = " ".join(shown.split())
    assert "Ended by the command abort, by terminal:wei, " in said
    assert "; step 50, mate" in said
