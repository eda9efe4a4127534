"""How raw images were exposed is a table of its own, not a list of single facts."""

from pathlib import Path

from cellctl.interfaces.exposure import ExposureRecord
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.report.exposures import exposures
from cellctl.records.report.run_sections import further_figures
from cellctl.records.report.sections import ReportTable
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from tests.unit.records.conftest import start


async def test_each_image_has_one_row_and_nothing_is_told_twice(tmp_path: Path) -> None:
    store = AsyncRunStore(tmp_path)
    recorder = RunRecorder(store, await store.do(start))
    assert not exposures(await store.do(RunStore.run, recorder.run)).blocks
    await recorder.exposures(
        {
            "raw/a.pgm.zst": ExposureRecord("FC-1", "RGB8", 8, 0.006, 1.5, 4, 1, 15_332),
            "raw/b.pgm.zst": ExposureRecord(None, "Mono8", 8),
            "raw/c.pgm.zst": None,
        }
    )
    record = await store.do(RunStore.run, recorder.run)
    store.close()
    (table,) = exposures(record).blocks
    assert isinstance(table, ReportTable)
    first, second = ([cell.text for cell in row.cells] for row in table.rows)
    assert first == ["raw/a.pgm.zst", "FC-1", "RGB8", "8", "6.000", "1.5", "4", "1"]
    assert second == ["raw/b.pgm.zst", "–", "Mono8", "8", "–", "–", "1", "0"]
    assert table.rows[0].cells[0].small == "clock of the camera 15332 ns"
    assert not further_figures(record, {}, frozenset()).blocks
