"""The requirements and headline figures of an insertion, also of one that came to no end."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.required import required_figures
from cellctl.processes.peg_in_hole.report.acceptance import acceptance
from cellctl.processes.peg_in_hole.report.pages import pages
from cellctl.processes.peg_in_hole.verdict.judgement import KEYED, LOW_FORCE, PULL, RETOUCH, SLIP
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import Artefact, Document, RunRecord
from cellctl.records.figures import Limit, figure
from cellctl.records.required.required_figures import required_document
from tests.unit.processes.peg_in_hole.plan.test_cycle_plan import RECIPE, SETTINGS
from tests.unit.processes.peg_in_hole.record.test_tick_log import ticked
from tests.unit.records.conftest import start

RATIO = figure(keys.check(SLIP), 20.0 / 60.0, "", limit=Limit(upper=0.6))
PEAK = figure(keys.PEAK, 17.74, "N", limit=Limit(upper=30.0))
EVIDENCE = {"greatest_force_n": 20.0, "grip_force_n": 60.0, "depth_m": 0.012}
RESULT = {"found_by": "spiral", "recoveries": [], "evidence": EVIDENCE}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


def ended(store: RunStore, result: RunResult, *details: Any) -> RunRecord:
    run = start(store, process="peg-in-hole")
    store.begin_phase(run, 30, "search and insert")
    if details:
        store.add(run, *details)
    store.close_run(run, result)
    return store.run(run)


def rows(record: RunRecord) -> dict[str, str]:
    """What each row shows, by its figure."""
    return {
        entry.figure: entry.title if entry.value is not None else "not measured"
        for group in acceptance(record)
        for entry in group.requirements
    }


def no_file(_artefact: Artefact) -> bytes:
    raise AssertionError("no file is listed")


def test_a_run_that_was_cut_off_has_measured_nothing_and_says_so(store: RunStore) -> None:
    shown = rows(ended(store, RunResult.ABORTED))
    assert set(shown.values()) == {"not measured"}
    assert {keys.PEAK, keys.check(SLIP)} <= set(shown)
    assert not {keys.check(KEYED), keys.check(PULL), keys.PANEL_SHIFT} & set(shown)


def test_what_only_some_parts_have_is_missed_of_those(store: RunStore) -> None:
    task = {"fit": {"keys": {"width_mm": 2.0}, "contacts": None}, "seat": {"pull_n": 5.0}}
    shown = rows(ended(store, RunResult.STOPPED, Document(keys.TASK, task)))
    assert {keys.check(KEYED), keys.check(PULL)} <= set(shown)


def test_a_touch_on_the_rear_stands_for_the_grip_force(store: RunStore) -> None:
    touched = figure(keys.check(RETOUCH), 0.1, "mm", limit=Limit(upper=0.15))
    shown = rows(ended(store, RunResult.BAD, touched))
    assert keys.check(SLIP) not in shown


def test_a_ratio_of_forces_names_both_in_its_row_and_on_its_tile(store: RunStore) -> None:
    record = ended(store, RunResult.GOOD, PEAK, RATIO, Document(keys.CYCLE, RESULT))
    assert rows(record)[keys.check(SLIP)].endswith("over the grip force: 20 N of 60 N")
    tiles = {tile.title: (tile.value, tile.bound) for tile in pages(record, no_file).tiles}
    assert tiles["Force over grip force"] == ("0.33", "20 N of 60 N, at most 0.6")
    assert tiles["Greatest force"] == ("17.7 N", "at most 30 N")


def test_a_search_that_was_cut_off_took_no_time_of_0_s(store: RunStore) -> None:
    figures = figure(keys.SEARCH_TIME, 0.0, "s"), figure(keys.TOUCHES, 0.0, "")
    (tile,) = pages(ended(store, RunResult.ABORTED, *figures), no_file).tiles
    assert (tile.title, tile.value, tile.bound) == (
        "Search",
        "not ended",
        "0 touches of the search",
    )


def test_how_hard_a_part_was_pressed_is_told_where_its_run_was_cut_off(store: RunStore) -> None:
    run = start(store, process="peg-in-hole")
    text = ticked(20).text().encode()
    store.add_artefact(run, keys.ticks(keys.INSERTION), text, "text/csv")
    store.close_run(run, RunResult.ABORTED)
    (tile,) = pages(store.run(run), lambda one: store.artefacts.get(one.sha256)).tiles
    assert (tile.title, tile.value) == ("Greatest force felt", "19.0 N")


def test_what_the_sections_and_the_first_page_have_is_not_listed_again(store: RunStore) -> None:
    record = ended(store, RunResult.GOOD, PEAK, RATIO, Document(keys.CYCLE, RESULT))
    made = pages(record, no_file)
    assert {keys.CYCLE, keys.TRACE, keys.CHOICE} <= made.documents
    assert keys.TASK not in made.documents


def test_every_item_of_the_verdict_is_required_and_has_its_words(store: RunStore) -> None:
    plan = cycle_plan(RECIPE, SETTINGS)
    asked = required_figures(plan)
    limits = {one.figure.key: (one.figure.lower, one.figure.upper) for one in asked}
    assert limits[keys.PEAK] == (None, plan.task.limits.insertion_n)
    assert limits[keys.check(LOW_FORCE)] == (plan.seat.least_n, None)
    cut = ended(store, RunResult.ABORTED, required_document(asked))
    shown = {entry.figure for group in acceptance(cut) for entry in group.requirements}
    assert shown == set(limits)
    touched = figure(keys.check(RETOUCH), 0.02, "mm", limit=Limit(upper=0.15))
    by_touch = rows(ended(store, RunResult.ABORTED, required_document(asked), touched))
    assert keys.check(SLIP) not in by_touch, "the touch on the rear counts in its place"
