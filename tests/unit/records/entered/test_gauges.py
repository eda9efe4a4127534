"""Plug gauges: they turn the verdict, keep their history, and belong to a part that there is."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.os_user import terminal_user
from cellctl.cli.records.runs import app
from cellctl.errors.records.store import GaugeRefused
from cellctl.records import RunResult, RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES, part_verdict
from cellctl.records.entries import DRY_RUN, Document
from cellctl.records.report.export import export_run
from tests.unit.records.conftest import start
from tests.unit.records.page import read, text_of

HOLES = {name: {"least_mm": 5.8, "most_mm": 6.0} for name in ("P1", "P5")}


@pytest.fixture
def run(store: RunStore) -> int:
    """A good part with two holes that can be gauged."""
    number = start(store)
    store.add(number, Document(GAUGE_HOLES, HOLES))
    store.close_run(number, RunResult.GOOD)
    return number


def test_a_gauge_beyond_its_limit_turns_the_verdict(store: RunStore, run: int) -> None:
    store.set_gauge(run, "P1", 5.95, "OP-7", "PG-3")
    assert part_verdict(store.run(run)) == "good"
    store.set_gauge(run, "P5", 5.70, "OP-7", "PG-3")
    record = store.run(run)
    assert part_verdict(record) == "bad"
    assert record.head.result == "good", "how the run ended is sealed"


@pytest.mark.parametrize(
    ("mm", "part"), [(5.799, "bad"), (5.8, "good"), (6.02, "good"), (6.05, "good")]
)
def test_the_tolerance_of_the_bore_counts_as_within(
    store: RunStore, run: int, mm: float, part: str
) -> None:
    store.set_gauge(run, "P1", mm, "OP-7")
    assert part_verdict(store.run(run)) == part


@pytest.mark.parametrize("mm", [6.051, 6.40, 50.0])
def test_a_gauge_that_the_bore_does_not_take_is_refused(
    store: RunStore, run: int, mm: float
) -> None:
    said = rf"{mm:g} mm in hole P1 of run {run}.*drawn as 6 mm; allowed up to 6\.05 mm: check"
    with pytest.raises(GaugeRefused, match=said):
        store.set_gauge(run, "P1", mm, "OP-7")
    assert store.run(run).gauge_history == ()
    assert part_verdict(store.run(run)) == "good"


def test_the_list_of_runs_says_so(store: RunStore, run: int) -> None:
    store.set_gauge(run, "P5", 5.70, "OP-7", "PG-3")
    assert _listed(store, run).endswith("good, bad by gauge")
    store.set_gauge(run, "P5", 5.90, "OP-7", "PG-3")
    assert _listed(store, run).endswith("good")


def _listed(store: RunStore, run: int) -> str:
    listed = CliRunner().invoke(
        app, ["list", "--data-dir", str(store.path)], env={"COLUMNS": "120"}
    )
    (line,) = (line for line in listed.stdout.splitlines() if line.split()[0] == str(run))
    return line.rstrip()


def test_both_entries_are_shown_everywhere(store: RunStore, run: int, tmp_path: Path) -> None:
    store.set_gauge(run, "P5", 5.70, "OP-7", "PG-3")
    store.set_gauge(run, "P5", 5.99, "OP-8", "PG-4")
    record = store.run(run)
    assert [entry.diameter_mm for entry in record.gauges] == [5.99]
    history = [(entry.diameter_mm, entry.gauge_id) for entry in record.gauge_history]
    assert history == [(5.70, "PG-3"), (5.99, "PG-4")]
    page = " ".join(read(export_run(store, run, tmp_path)).texts)
    for word in ("5.70", "PG-3", "OP-7", "5.99", "PG-4", "OP-8", "replaced by a later entry"):
        assert word in page, word
    document = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert [entry["diameter_mm"] for entry in document["gauge_history"]] == [5.70, 5.99]
    assert document["gauge_history"][0]["time"]
    shown = CliRunner().invoke(app, ["show", str(run), "--data-dir", str(store.path)]).stdout
    assert "gauge 5.70 mm (OP-7)" in shown
    assert "replaced by a later entry" in shown
    assert "gauge 5.99 mm (OP-8)" in shown


def test_the_report_and_show_say_bad(store: RunStore, run: int, tmp_path: Path) -> None:
    store.set_gauge(run, "P5", 5.70, "OP-7")
    page = " ".join(read(export_run(store, run, tmp_path)).texts)
    assert "Bad part by gauge" in page
    assert "Good part" not in page
    assert json.loads((tmp_path / "run.json").read_text())["part_verdict"] == "bad"
    shown = CliRunner().invoke(app, ["show", str(run), "--data-dir", str(store.path)]).stdout
    assert "the part is bad: a plug gauge is beyond its limit" in shown


def test_programs_are_told_the_same_everywhere(store: RunStore, run: int, tmp_path: Path) -> None:
    where = ["--data-dir", str(store.path)]
    for hole, mm in (("P5", "5.70"), ("P1", "5.95")):
        words = ["--hole", hole, "--mm", mm, "--source", "anna"]
        assert CliRunner().invoke(app, ["gauge", str(run), *words, *where]).exit_code == 0
    export_run(store, run, tmp_path)
    exported = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    (listed,) = json.loads(CliRunner().invoke(app, ["list", "--json", *where]).stdout)
    shown = json.loads(CliRunner().invoke(app, ["show", str(run), "--json", *where]).stdout)
    assert {told["part_verdict"] for told in (exported, listed, shown)} == {"bad"}
    assert (exported["result"], listed["result"], shown["head"]["result"]) == ("good",) * 3
    assert "spoilt" not in listed
    anna = f"anna, typed by {terminal_user()}"
    for told in (exported, shown):
        for name in ("gauges", "gauge_history"):
            assert {gauge["hole"]: gauge["verdict"] for gauge in told[name]} == {
                "P5": "fail",
                "P1": "pass",
            }
            assert {gauge["measured_by"] for gauge in told[name]} == {anna}


def test_a_hole_that_there_is_not_is_refused(store: RunStore, run: int) -> None:
    with pytest.raises(GaugeRefused, match="no pin hole P9; it has P1, P5"):
        store.set_gauge(run, "P9", 5.95, "OP-7")
    assert store.run(run).gauge_history == ()


@pytest.mark.parametrize("result", [RunResult.ABORTED, RunResult.STOPPED, RunResult.INTERRUPTED])
def test_a_run_without_a_part_is_refused(store: RunStore, result: RunResult) -> None:
    number = start(store)
    store.close_run(number, result)
    with pytest.raises(GaugeRefused, match=f"is {result}: it has no finished part"):
        store.set_gauge(number, "P1", 5.95, "OP-7")


def test_a_dry_run_has_no_part_to_gauge(store: RunStore) -> None:
    number = start(store, mode=DRY_RUN)
    store.close_run(number, RunResult.BAD)
    with pytest.raises(GaugeRefused, match="is a dry run: its part was never joined"):
        store.set_gauge(number, "P1", 5.95, "OP-7")


def test_the_command_tells_of_the_entry_before(store: RunStore, run: int) -> None:
    where = ["--data-dir", str(store.path)]
    options = ["--hole", "P5", "--source", "OP-7", "--gauge-id", "PG-3"]
    CliRunner().invoke(app, ["gauge", str(run), "--mm", "5.70", *options, *where])
    told = CliRunner().invoke(app, ["gauge", str(run), "--mm", "5.99", *options, *where]).stdout
    by = f"OP-7, typed by {terminal_user()}"
    assert f"5.70 mm ({by}), required 5.8 to 6.05 mm: fail, gauge PG-3" in told
    assert f"5.99 mm ({by}), required 5.8 to 6.05 mm: pass" in told


def test_a_run_that_nobody_has_closed_has_no_part_to_gauge(store: RunStore) -> None:
    open_run = start(store)
    with pytest.raises(GaugeRefused, match=r"is not closed.*killed"):
        store.set_gauge(open_run, "P1", 5.95, "OP-7")
    assert store.run(open_run).gauge_history == ()


def test_a_note_on_an_open_run_is_kept_and_says_that_it_is_open(store: RunStore) -> None:
    arguments = ["note", str(start(store)), "--by", "OP-7", "--remark", "power failed"]
    done = CliRunner().invoke(app, [*arguments, "--data-dir", str(store.path)])
    assert done.exit_code == 0, done.output
    assert "is not closed" in done.output
    assert "power failed" in done.output


def test_the_first_page_says_what_a_gauge_has_replaced(
    store: RunStore, run: int, tmp_path: Path
) -> None:
    store.set_gauge(run, "P5", 5.70, "OP-7", "PG-3")
    store.set_gauge(run, "P5", 5.99, "OP-8", "PG-4")
    page = text_of(export_run(store, run, tmp_path))
    first = page.split("Timeline")[0]
    assert "gauge through hole P5 (replaces 5.70 mm of OP-7)" in first
