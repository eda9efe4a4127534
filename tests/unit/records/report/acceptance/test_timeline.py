"""All alarms of the time of a run, those of the cell with those of the run."""

from pathlib import Path

from cellctl.records import RunResult, RunStore
from cellctl.records.procedure_entries import MADE_BY_PROCEDURES
from cellctl.records.report.export import export_run
from tests.unit.records.conftest import start
from tests.unit.records.page import text_of


def test_alarms_of_the_cell_stand_in_the_timeline_of_their_time(
    store: RunStore, tmp_path: Path
) -> None:
    store.add_alarm(None, 701, "F701 acknowledged before")
    store.acknowledge_alarms(701, "line")
    store.add_alarm(None, 701, "F701 Line PLC lost")
    run = start(store)
    store.add_alarm(None, 814, "F814 disk")
    store.acknowledge_alarms(814, "anna")
    store.close_run(run, RunResult.ABORTED)
    store.add_alarm(None, 501, "F501 later")
    page = " ".join(text_of(export_run(store, run, tmp_path)).split())
    assert "F701 Line PLC lost (of the cell, not acknowledged when the run began)" in page
    assert "F814 disk (of the cell)" in page
    assert "alarm F814 acknowledged anna" in page
    assert "acknowledged before" not in page
    assert "F501 later" not in page


def test_only_what_somebody_commanded_is_called_a_command(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.audit("line", "hold")
    for made in sorted(MADE_BY_PROCEDURES):
        store.audit("line", made, {"item": "head_1"})
    store.close_run(run, RunResult.ABORTED)
    page = " ".join(text_of(export_run(store, run, tmp_path)).split())
    assert "command hold" in page
    for made in MADE_BY_PROCEDURES:
        assert made in page
        assert f"command {made}" not in page
