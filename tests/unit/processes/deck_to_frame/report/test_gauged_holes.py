"""One verdict on a plug gauge: on card, pages and chart, as on the first page."""

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from cellctl.processes.deck_to_frame.report.gauge_plot import plug_gauges
from cellctl.processes.deck_to_frame.report.gauged_holes import gauged_holes
from cellctl.processes.deck_to_frame.report.pages import pages
from cellctl.processes.deck_to_frame.report.tiles import tiles
from cellctl.records import RunResult, RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES, part_verdict
from cellctl.records.entries import Document, Gauge, RunRecord
from cellctl.records.report.acceptance.table import acceptance
from cellctl.records.report.sections import ReportTable, RowMark, TableRow
from tests.unit.records.conftest import start


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


OF_SIX = {"least_mm": 5.8, "most_mm": 6.0}


def gauged(
    store: RunStore, gauges_mm: dict[str, float], *, limits: dict[str, float] | None = None
) -> RunRecord:
    """A good run with these gauges, whether or not they would be taken today."""
    run = start(store)
    if limits:
        store.add(run, Document(GAUGE_HOLES, dict.fromkeys(gauges_mm, limits)))
    store.close_run(run, RunResult.GOOD)
    now = datetime(2026, 1, 1, tzinfo=UTC)
    gauges = tuple(Gauge(now, hole, mm, "anna") for hole, mm in gauges_mm.items())
    return replace(store.run(run), gauges=gauges, gauge_history=gauges)


def rows_of(record: RunRecord) -> list[TableRow]:
    """Of both tables of the page of the pin holes."""
    (section,) = (one for one in pages(record, lambda _: b"").sections if one.title == "Pin holes")
    return [row for block in section.blocks if isinstance(block, ReportTable) for row in block.rows]


@pytest.mark.parametrize(
    ("beyond_mm", "bound"), [(6.40, "of 6.00, at most 6.05"), (5.70, "of 6.00, at least 5.80")]
)
def test_a_gauge_that_fails_fails_everywhere(store: RunStore, beyond_mm: float, bound: str) -> None:
    record = gauged(store, {"P1": beyond_mm, "P5": 5.99}, limits=OF_SIX)
    assert part_verdict(record) == "bad"
    (tile,) = tiles(record, ())
    assert (tile.title, tile.value, tile.bound, tile.passed) == (
        "Plug gauge P1", f"{beyond_mm:.2f} mm", bound, False,
    )  # fmt: skip
    rows = rows_of(record)
    assert [row.cells[0].text for row in rows] == ["P1", "P5", "P1", "P5"]
    for row in rows:
        fails = row.cells[0].text == "P1"
        texts = [cell.text for cell in row.cells]
        assert ("beyond" in texts, "within" in texts) == (fails, not fails)
        assert row.mark is (RowMark.BAD if fails else RowMark.GOOD)
        assert not any(text.startswith(("-", "−")) for text in texts)
    table = acceptance(record, ()).blocks[0]
    assert isinstance(table, ReportTable)
    said = {row.cells[0].text: row.mark for row in table.rows}
    assert said["gauge through hole P1"] is RowMark.BAD
    assert said["gauge through hole P5"] is RowMark.GOOD


def test_the_least_gauge_is_on_the_card_where_none_fails(store: RunStore) -> None:
    record = gauged(store, {"P1": 6.02, "P5": 5.93}, limits=OF_SIX)
    (tile,) = tiles(record, ())
    assert (tile.title, tile.value, tile.passed) == ("Least plug gauge", "5.93 mm", True)
    wide, narrow = (row.cells[2].text for row in rows_of(record)[:2])
    assert (wide, narrow) == ("–", "0.07"), "a wide bore tells nothing of the offset"


def test_limits_are_those_of_the_run(store: RunStore) -> None:
    record = gauged(store, {"P1": 7.95}, limits={"least_mm": 7.9, "most_mm": 8.0})
    (tile,) = tiles(record, ())
    assert (tile.bound, tile.passed) == ("of 8.00, at least 7.90", True)
    assert rows_of(record)[0].cells[2].text == "0.05"
    assert "hole 8.00" in plug_gauges(gauged_holes(record))


def test_what_the_run_does_not_judge_has_no_verdict(store: RunStore) -> None:
    record = gauged(store, {"P1": 5.70})
    assert part_verdict(record) == "good"
    (tile,) = tiles(record, ())
    assert tile.passed is None
    assert {row.mark for row in rows_of(record)} == {RowMark.NONE}


@pytest.mark.parametrize("mm", [6.40, 5.70, 2.0])
def test_no_bar_leaves_the_chart(store: RunStore, mm: float) -> None:
    drawing = plug_gauges(gauged_holes(gauged(store, {"P1": mm, "P5": 5.99}, limits=OF_SIX)))
    # A label is drawn only where its point lies within the axes; what its glyphs say is a comment.
    for label in (mm, 5.99):
        assert f"<!-- {label:.2f} mm -->" in drawing
