"""The store behind its thread: order, faults, and writes that are not taken back."""

import asyncio
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.records.store import RecordNotWritten, StoreUnavailable, ValueRefused
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore


@pytest.fixture
def archive(tmp_path: Path) -> Iterator[AsyncRunStore]:
    archive = AsyncRunStore(tmp_path)
    yield archive
    archive.close()


async def test_writes_keep_their_order(archive: AsyncRunStore) -> None:
    await asyncio.gather(*(archive.do(RunStore.note_line_seq, seq) for seq in range(1, 20)))
    assert await archive.do(RunStore.line_seq) == 19


async def test_a_cancelled_caller_does_not_take_back_its_write(archive: AsyncRunStore) -> None:
    entered, may_go_on = threading.Event(), threading.Event()

    def blocked(_store: RunStore) -> None:
        entered.set()
        assert may_go_on.wait(5)

    blocking = asyncio.create_task(archive.do(blocked))
    await asyncio.to_thread(entered.wait, 5)
    waiting = asyncio.create_task(archive.do(RunStore.note_line_seq, 7))
    await asyncio.sleep(0)
    waiting.cancel()
    with pytest.raises(asyncio.CancelledError):
        await waiting
    may_go_on.set()
    await blocking
    assert await archive.do(RunStore.line_seq) == 7


async def test_the_first_write_that_failed_is_remembered(archive: AsyncRunStore) -> None:
    def full(_store: RunStore) -> None:
        raise RecordNotWritten("disk full")

    with pytest.raises(ValueRefused):
        await archive.do(RunStore.set_gauge, 1, "P1", 99.0, "operator")
    assert archive.fault is None
    with pytest.raises(RecordNotWritten):
        await archive.do(full)
    assert archive.fault is not None
    assert archive.fault.detail == "disk full"


def test_a_store_that_cannot_be_opened_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "store.sqlite").mkdir()
    with pytest.raises(StoreUnavailable):
        AsyncRunStore(tmp_path)


async def test_an_image_that_cannot_be_coded_is_told(
    archive: AsyncRunStore, capsys: pytest.CaptureFixture[str]
) -> None:
    colour = np.zeros((4, 4, 3), np.uint8)
    archive.keep_image(1, "raw/look.pgm.zst", colour)
    await archive.images_kept()
    await asyncio.sleep(0)
    assert "raw image not kept" in "".join(capsys.readouterr())
