"""Images and rims are tables of their own, not lists of single facts."""

from datetime import UTC, datetime
from pathlib import Path

from cellctl.interfaces.exposure import ExposureRecord
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunRecord
from cellctl.records.looks import MeasuredRim, TakenImage, documents_of_look
from cellctl.records.report.images import raw_images, rims
from cellctl.records.report.run_sections import further_figures
from cellctl.records.report.sections import ReportSection, ReportTable, RowMark
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from tests.unit.records.conftest import start

AT = datetime(2026, 5, 4, 10, 20, 30, 123_000, tzinfo=UTC)
FOUND = MeasuredRim("P1", (1659.05164, 1631.77), (0.00478, 0.0044), (1659.1, 1631.8), (19.446, 18.5), 1.96, 2.24)  # fmt: skip # noqa: E501
MISSED = MeasuredRim("P2", (16.0, 17.0), None, (16.0, 17.0), (9.0, 8.0), 0.0, None, used=False)


def table_of(section: ReportSection) -> ReportTable:
    table = section.blocks[0]
    assert isinstance(table, ReportTable)
    return table


async def test_each_image_and_each_rim_has_one_row_and_nothing_is_told_twice(
    tmp_path: Path,
) -> None:
    store = AsyncRunStore(tmp_path)
    recorder = RunRecorder(store, await store.do(start))
    empty = await store.do(RunStore.run, recorder.run)
    assert not raw_images(empty).blocks
    assert not rims(empty).blocks
    await recorder.exposures(
        {
            "raw/a.pgm.zst": ExposureRecord("FC-1", "RGB8", 8, 0.006, 1.5, 4, 1, 15_332),
            "raw/b.pgm.zst": ExposureRecord(None, "Mono8", 8),
            "raw/c.pgm.zst": None,
        }
    )
    taken = {"raw/a.pgm.zst": TakenImage("frame", "head-1-left", AT)}
    looked = documents_of_look("frame", taken, {"head-1-left": (FOUND, MISSED)})
    await recorder.add(*looked)
    record = await store.do(RunStore.run, recorder.run)
    store.close()
    check_images(record)
    check_rims(record)
    assert not further_figures(record, {}, frozenset()).blocks


def check_images(record: RunRecord) -> None:
    table = table_of(raw_images(record))
    first, second = ([cell.text for cell in row.cells] for row in table.rows)
    assert first == [
        "a", "10:20:30.123", "FC-1", "15332", "RGB8", "8", "6.000", "1.5", "4", "1",
    ]  # fmt: skip
    assert second == ["b", "–", "–", "–", "Mono8", "8", "–", "–", "1", "0"]


def check_rims(record: RunRecord) -> None:
    found, missed = table_of(rims(record)).rows
    assert [cell.text for cell in found.cells] == [
        "frame, head-1-left", "P1", "1659.052", "1631.770", "0.0048", "0.0044", "19.45", "18.50",
        "2.2", "yes",
    ]  # fmt: skip
    assert [cell.text for cell in missed.cells[4:6]] == ["–", "–"]
    assert missed.mark is RowMark.BAD
