"""Raw images: without loss, in their run before it is closed, and never in the way of it."""

import asyncio
import os
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.records.store import ArtefactDamaged
from cellctl.records import RunResult, RunStore
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.files.raw_images import MEDIA_TYPE, coding_thread, decode
from tests.unit.records.conftest import start


@pytest.fixture
def archive(tmp_path: Path) -> Iterator[AsyncRunStore]:
    archive = AsyncRunStore(tmp_path)
    yield archive
    archive.close()


async def test_every_bit_of_an_image_is_kept(archive: AsyncRunStore) -> None:
    run = await archive.do(start)
    image = np.random.default_rng(1).integers(0, 256, (120, 160), dtype=np.uint8)
    archive.keep_image(run, "raw/deck.pgm.zst", image)
    await archive.images_kept()
    await archive.do(RunStore.close_run, run, RunResult.GOOD)
    (artefact,) = (await archive.do(RunStore.run, run)).artefacts
    assert (artefact.name, artefact.media_type) == ("raw/deck.pgm.zst", MEDIA_TYPE)
    data = await archive.do(lambda store: store.artefacts.get(artefact.sha256))
    np.testing.assert_array_equal(decode(data), image)
    assert await archive.do(RunStore.verify) == []


async def test_a_run_goes_on_while_its_images_are_coded(
    archive: AsyncRunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    coded = threading.Event()
    monkeypatch.setattr(
        "cellctl.records.async_store.encode_and_put", lambda *_: coded.wait(10) and b"late"
    )
    run = await archive.do(start)
    try:
        archive.keep_image(run, "raw/deck.pgm.zst", np.zeros((2, 2), np.uint8))
        await asyncio.wait_for(archive.do(RunStore.audit, "OP-7", "goes on"), 1.0)
        await asyncio.wait_for(archive.images_kept(timeout_s=0.05), 1.0)
        await archive.do(RunStore.close_run, run, RunResult.GOOD)
    finally:
        coded.set()
    await archive.images_kept()
    assert (await archive.do(RunStore.run, run)).artefacts == (), "too late for its run"


def test_the_coding_thread_is_as_urgent_as_the_event_loop() -> None:
    """A nicer one could hold the interpreter's lock while it waits for a processor."""
    thread = coding_thread()
    niceness = thread.submit(lambda: os.getpriority(os.PRIO_PROCESS, threading.get_native_id()))
    assert niceness.result() == os.getpriority(os.PRIO_PROCESS, 0)
    thread.shutdown()


def test_what_is_no_image_is_said_to_be_none() -> None:
    with pytest.raises(ArtefactDamaged):
        decode(b"not an image")
