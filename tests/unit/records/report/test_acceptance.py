"""The first page: requirements, parts, people, faults; what is unknown says so."""

import json
import re
from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.records import RunResult, RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entered.notes import add_note
from cellctl.records.entries import Document, RunRecord, Verdict
from cellctl.records.figures import NO_LIMIT, Limit, figure
from cellctl.records.report.acceptance.requirement import (
    Requirement,
    RequirementGroup,
    guarded,
    of_figure,
)
from cellctl.records.report.acceptance.table import acceptance, limit_text
from cellctl.records.report.acceptance.timeline import during
from cellctl.records.report.export import export_run
from cellctl.records.report.sections import (
    Part,
    ProcessPages,
    ReadArtefact,
    ReportTable,
    RowMark,
)
from tests.unit.records.conftest import start
from tests.unit.records.page import text_of
from tests.unit.records.sample import good_run

ROOT = "terminal:root"


def rows_of(record: RunRecord, *groups: RequirementGroup) -> list[tuple[str, ...]]:
    table = acceptance(record, groups).blocks[0]
    assert isinstance(table, ReportTable)
    return [tuple(cell.text for cell in row.cells) for row in table.rows]


def test_a_guarded_figure_shows_the_required_and_the_accepted_limit(store: RunStore) -> None:
    run = start(store)
    store.begin_phase(run, 60, "verify")
    store.add(
        run,
        figure("offset", 0.1234567, "mm", limit=Limit(upper=0.19)),
        figure("offset_uncertainty", 0.01, "mm"),
    )
    record = store.run(run)
    found = guarded(record, "offset", "offset at the hole", record.value("offset_uncertainty"))
    assert found is not None
    assert found.required.upper == pytest.approx(0.2)
    assert found.accepted == Limit(upper=0.19)
    rows = rows_of(record, RequirementGroup("Seat", (found,), "frame axes"))
    assert rows[1] == (
        "offset at the hole", "0.123 mm", "0.010 mm", "≤ 0.2 mm", "≤ 0.190 mm", "✓ conforms",
        "verify",
    )  # fmt: skip
    assert len(rows) == 2, "the figure is not shown a second time among the others"


def test_a_value_without_any_uncertainty_keeps_its_figures(store: RunStore) -> None:
    run = start(store)
    store.add(
        run,
        figure("offset", 0.02076, "mm", limit=Limit(upper=0.2)),
        figure("offset_uncertainty", 0.0, "mm"),
    )
    record = store.run(run)
    found = guarded(record, "offset", "offset", record.value("offset_uncertainty"))
    assert found is not None
    rows = rows_of(record, RequirementGroup("Seat", (found,)))
    assert rows[1][1:5] == ("0.02076 mm", "0 mm", "≤ 0.2 mm", "≤ 0.2 mm")


def test_figures_that_no_process_names_follow_and_a_bad_one_says_so(store: RunStore) -> None:
    run = start(store)
    store.add(
        run,
        figure("force", 61.0, "N", limit=Limit(upper=50.0)),
        figure("depth", None, "mm", limit=Limit(2.35, 2.65)),
        figure("speed", 3.0, "mm/s"),
    )
    record = store.run(run)
    rows = rows_of(record)
    assert ("force", "61 N", "not stated", "≤ 50 N", "–", "✗ does not conform", "–") in rows
    assert ("depth", "–", "–", "2.35 to 2.65 mm", "–", "✗ not measured", "–") in rows
    assert not any("speed" in row[0] for row in rows)
    table = acceptance(record, ()).blocks[0]
    assert isinstance(table, ReportTable)
    assert [row.mark for row in table.rows] == [RowMark.GROUP, RowMark.BAD, RowMark.BAD]


def test_holes_that_nobody_has_gauged_are_listed(store: RunStore) -> None:
    run = start(store)
    holes = {name: {"least_mm": 5.8, "most_mm": 6.0} for name in ("P1", "P5")}
    store.add(run, Document(GAUGE_HOLES, holes))
    store.close_run(run, RunResult.GOOD)
    store.set_gauge(run, "P1", 5.7, "somebody")
    verdicts = {row[0]: row[5] for row in rows_of(store.run(run))[1:]}
    assert verdicts == {
        "gauge through hole P1": "✗ does not conform",
        "gauge through hole P5": "optional, not entered",
    }


def test_a_figure_without_a_limit_is_no_requirement(store: RunStore) -> None:
    run = start(store)
    store.add(run, figure("speed", 3.0, "mm/s"))
    record = store.run(run)
    assert of_figure(record, "speed") is None
    assert guarded(record, "missing", "", None) is None
    assert acceptance(record, ()).blocks == ()


@pytest.mark.parametrize(
    ("value", "accepted", "verdict"),
    [
        (0.0021, NO_LIMIT, "? not decided: U > margin"),
        (0.0005, NO_LIMIT, "✓ conforms"),
        (0.0051, NO_LIMIT, "✗ does not conform"),
        (0.0021, Limit(upper=0.003), "✓ conforms"),
    ],
)
def test_a_row_whose_margin_is_below_its_uncertainty_is_not_decided(
    store: RunStore, value: float, accepted: Limit, verdict: str
) -> None:
    limit = Limit(upper=0.005)
    entry = Requirement(
        "angle", value, "°", limit, limit.judge(value), expanded=0.0042, accepted=accepted
    )
    rows = rows_of(store.run(start(store)), RequirementGroup("Group", (entry,)))
    assert rows[1][5] == verdict


@pytest.mark.parametrize("limit", [Limit(upper=0.006), Limit(-0.006, 0.006)])
def test_no_value_conforms_that_is_known_worse_than_its_limit(
    store: RunStore, limit: Limit
) -> None:
    entry = Requirement("angle", 0.001, "°", limit, Verdict.PASS, expanded=0.008)
    record = store.run(start(store))
    table = acceptance(record, (RequirementGroup("Group", (entry,)),)).blocks[0]
    assert isinstance(table, ReportTable)
    row = table.rows[1]
    assert (row.cells[5].text, row.mark) == ("? not decided: U > limit", RowMark.NONE)


def test_a_value_without_a_limit_is_not_called_unmeasured(store: RunStore) -> None:
    entry = Requirement("something", 1.0, "mm", NO_LIMIT, None)
    rows = rows_of(store.run(start(store)), RequirementGroup("Group", (entry,)))
    assert rows[1][5] == "no limit known"


@pytest.mark.parametrize(
    ("limit", "text"),
    [
        (Limit(upper=0.2), "≤ 0.2 mm"),
        (Limit(lower=2.0), "≥ 2 mm"),
        (Limit(-0.1, 0.1), "± 0.1 mm"),
        (Limit(2.35, 2.65), "2.35 to 2.65 mm"),
        (NO_LIMIT, "–"),
    ],
)
def test_limits_in_signs(limit: Limit, text: str) -> None:
    assert limit_text(limit, "mm") == text


def test_a_fault_has_its_step_cause_and_remedy(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.begin_phase(run, 50, "mate")
    text = "F504 Contact later than expected: 10.2 mm"
    store.add_alarm(run, 504, text)
    store.close_run(run, RunResult.ABORTED, fault_number=504, fault=text)
    page = text_of(export_run(store, run, tmp_path))
    for expected in (text, "Step: 50, mate", "Cause: ", "Remedy: ", "50, mate"):
        assert expected in page, expected


def test_a_run_that_somebody_ended_names_him(store: RunStore, tmp_path: Path) -> None:
    store.audit("terminal:lin", "start", {"serial": "SAT-0001"})
    run = start(store)
    store.audit("terminal:wei", "abort", {})
    store.audit("terminal:bo", "abort", {"refused": "not in this state"})
    store.close_run(run, RunResult.ABORTED)
    page = text_of(export_run(store, run, tmp_path))
    assert re.search(r"Ended by the command abort, by terminal:wei, \d{4}-", page)
    assert "Cause:" not in page
    assert "terminal:lin" in page, "who started it"


def test_a_run_that_complete_ended_says_so_and_one_that_came_to_its_end_does_not(
    store: RunStore, tmp_path: Path
) -> None:
    run = start(store)
    store.audit("line", "complete", {"refused": "not in this state"})
    store.close_run(run, RunResult.BAD)
    assert "Ended by the command" not in text_of(export_run(store, run, tmp_path / "own end"))
    run = start(store)
    store.audit("line", "complete", {})
    store.close_run(run, RunResult.BAD)
    page = text_of(export_run(store, run, tmp_path / "completed"))
    assert re.search(r"Ended by the command complete, by line, \d{4}-", page)


def test_the_timeline_has_only_what_belongs_to_the_run(store: RunStore) -> None:
    store.audit("line", "start", {"serial": "earlier"})
    store.audit("line", "reset", {})
    store.audit("OP-7", "start", {"serial": "SAT-0001"})
    run = start(store)
    store.audit("OP-8", "start", {"serial": "SAT-0001", "refused": "not in this state"})
    store.close_run(run, RunResult.GOOD)
    store.audit("line", "reset", {})
    record, log = store.run(run), store.audit_log()
    assert [entry.actor for entry in during(record, log)] == ["OP-7", "OP-8"]
    late = [entry for entry in log if entry.time > record.head.started - timedelta(0)]
    assert [entry.actor for entry in during(record, late)] == ["OP-8"], "which started nothing"


def test_what_somebody_noted_stands_on_the_first_page_and_in_the_timeline(
    store: RunStore, tmp_path: Path
) -> None:
    run = good_run(store)
    other = good_run(store)
    values = {"temperature_deg_c": 12.0, "humidity_percent": 44.0}
    add_note(store, run, ROOT, "anna", values, instrument="TH-3")
    add_note(store, run, ROOT, "bo", {"temperature_deg_c": 21.3}, remark="door was open")
    add_note(store, other, ROOT, "cy", {"pressure_hpa": 990.0})
    report = export_run(store, run, tmp_path)
    page = " ".join(text_of(report).split())
    typed = f"typed by {ROOT}"
    for expected in (
        f"temperature 21.3 °C (bo, {typed})",
        f"relative humidity 44 % (anna, {typed}, TH-3)",
        "air pressure not recorded",
        f"note: temperature 12 °C, relative humidity 44 %, instrument TH-3 anna, {typed}",
        f"note: temperature 21.3 °C, door was open bo, {typed}",
    ):
        assert expected in page, expected
    # The unit is part of it, because a hash on the page may hold the digits.
    assert "990 hPa" not in page, "that is the note of another run"
    plain = json.loads((tmp_path / "run.json").read_text())
    assert [note["actor"] for note in plain["notes"]] == [ROOT, ROOT]
    assert store.verify() == []


def test_parts_and_surroundings_that_nobody_recorded_say_so(
    store: RunStore, tmp_path: Path
) -> None:
    def pages(record: RunRecord, _read: ReadArtefact) -> ProcessPages:
        return ProcessPages(parts=(Part("deck", record.head.serial), Part("frame", "")))

    page = " ".join(text_of(export_run(store, start(store), tmp_path, pages=pages)).split())
    for expected in (
        "serial number, deck SAT-0001",
        "serial number, frame not recorded",
        "temperature, relative humidity, air pressure not recorded",
        "order, as given with Start OP-7",
        "started by not recorded",
        "performed by",
        "accepted by",
    ):
        assert expected in page, expected


def test_a_remark_stands_above_the_signatures(store: RunStore, tmp_path: Path) -> None:
    run = good_run(store)
    add_note(store, run, ROOT, "bo", {}, remark="door was open")
    page = " ".join(text_of(export_run(store, run, tmp_path)).split())
    assert f"remark door was open (bo, typed by {ROOT}" in page.split("Timeline")[0]


@pytest.mark.parametrize("result", [RunResult.INTERRUPTED, None])
def test_a_run_that_was_cut_off_says_so_above_its_figures(
    store: RunStore, tmp_path: Path, result: RunResult | None
) -> None:
    run = start(store)
    store.begin_phase(run, 50, "mate")
    if result is not None:
        store.close_run(run, result)
    page = " ".join(text_of(export_run(store, run, tmp_path)).split())
    assert ("Interrupted: the daemon ended" if result else "Not closed: this run") in page
    assert "Step: 50, mate" in page
    assert "make the run again" in page
