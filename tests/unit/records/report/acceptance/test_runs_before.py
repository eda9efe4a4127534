"""What was done before with a part is on the page that is signed for it."""

import json
from pathlib import Path

from cellctl.records import RunResult, RunStore
from cellctl.records.report.acceptance.runs_before import runs_before, words_of_runs_before
from cellctl.records.report.export import export_run
from tests.unit.records.conftest import start
from tests.unit.records.page import text_of


def test_earlier_runs_of_a_part_stand_on_the_first_page_of_the_next(
    store: RunStore, tmp_path: Path
) -> None:
    pressed = start(store, "PIN-2")
    store.begin_phase(pressed, 30, "search and insert")
    store.close_run(pressed, RunResult.ABORTED, fault_number=704, fault="F704 Line PLC lost")
    start(store, "PIN-3")
    start(store, "PIN-2", mode="dry run")
    run = start(store, "PIN-2")
    start(store, "PIN-2")
    report = export_run(store, run, tmp_path)
    first = " ".join(text_of(report).split()).split("Timeline")[0]
    assert first.count("this part before") == 1
    assert f"run {pressed}, panel 500 x 1000, aborted, " in first
    assert "last step 30, search and insert: F704 Line PLC lost" in first
    (before,) = json.loads((tmp_path / "run.json").read_text())["runs_before"]
    assert (before["number"], before["fault"]) == (pressed, "F704 Line PLC lost")


def test_many_runs_of_a_part_are_counted(store: RunStore) -> None:
    runs = [start(store, "PIN-2") for _ in range(9)]
    lines = list(words_of_runs_before(runs_before(store, store.run(runs[-1]).head)))
    assert len(lines) == 7
    assert lines[0].startswith("run 8, ")
    assert lines[-1] == "and 2 more"
