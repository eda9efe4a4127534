"""What a procedure keeps of its readings, for whoever computes its result anew."""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from cellctl.clock import now_s
from cellctl.interfaces import StereoPair
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunRecord, RunResult
from cellctl.records.files.raw_images import decode
from cellctl.records.looks import taken_images
from cellctl.records.replay.recorded_run import PROCEDURE_INPUT, RecordedRun
from cellctl.records.run_recorder import EXPOSURES
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.record import JobRecord
from cellctl.runtime.procedure import ProcedureContext, views_of_pair
from cellctl.runtime.progress import ProgressBoard
from tests.unit.records.conftest import start


class OpenRecord:
    """The record of a job, open or not yet."""

    def __init__(self, store: AsyncRunStore, number: int) -> None:
        self.store, self.number = store, number


@pytest.fixture
def archive(tmp_path: Path) -> Iterator[AsyncRunStore]:
    archive = AsyncRunStore(tmp_path / "runs")
    yield archive
    archive.close()


async def go_on(*, hold: bool = False) -> bool:
    return hold


def context(archive: AsyncRunStore, number: int) -> ProcedureContext:
    record = cast(JobRecord, OpenRecord(archive, number))
    return ProcedureContext(ProgressBoard(), go_on, record)


def pair(grey: int) -> StereoPair:
    exposure = ExposureRecord("C-1", "Mono8", 8, exposure_s=0.01)
    left = np.full((4, 6), grey, np.uint8)
    return StereoPair(left, left + np.uint8(1), now_s(), grey, (exposure, exposure))


async def closed(archive: AsyncRunStore, number: int) -> RunRecord:
    await archive.images_kept()
    await archive.do(RunStore.close_run, number, RunResult.GOOD)
    return await archive.do(RunStore.run, number)


async def test_images_are_kept_with_time_and_exposure(archive: AsyncRunStore) -> None:
    number = await archive.do(start)
    files = await context(archive, number).keep_images("view-3", views_of_pair("head_1", pair(7)))
    left, right = files
    assert left == "raw/view-3-frame-1-head_1-left.pgm.zst"
    record = await closed(archive, number)
    run = RecordedRun(record, lambda one: archive._store.artefacts.get(one.sha256), {})
    np.testing.assert_array_equal(run.image(left), np.full((4, 6), 7))
    np.testing.assert_array_equal(run.image(right), np.full((4, 6), 8))
    taken = taken_images(record)[right]
    assert (taken.look, taken.view) == ("view-3", "head_1-right")
    assert record.document(EXPOSURES)[left]["exposure_s"] == 0.01
    assert decode(run.file(left)).shape == (4, 6)


async def test_after_a_hold_nothing_hides_what_was_seen_before(archive: AsyncRunStore) -> None:
    number = await archive.do(start)
    kept = context(archive, number)
    for grey in (1, 2):
        files = await kept.keep_images("view-1", views_of_pair("head_1", pair(grey)))
        await kept.keep_input({"views": files, f"of {grey}": True})
    record = await closed(archive, number)
    images = [one.name for one in record.artefacts if one.name.startswith("raw/")]
    assert len(images) == 4
    assert files[0] == "raw/view-1-again-2-frame-1-head_1-left.pgm.zst"
    assert list(record.document(PROCEDURE_INPUT)["views"]) == files, "the newest counts"


async def test_before_the_record_is_open_nothing_is_kept(archive: AsyncRunStore) -> None:
    early = context(archive, 0)
    assert len(await early.keep_images("view-1", views_of_pair("head_1", pair(1)))) == 2
    await early.keep_input({"views": []})
    assert await archive.do(RunStore.runs) == []
