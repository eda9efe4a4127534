"""Another program that writes to the store keeps the daemon waiting, and does not break it."""

import asyncio
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from shutil import copytree

import pytest
from structlog.testing import capture_logs

from cellctl.errors.records.store import StoreLocked
from cellctl.records import RunResult, RunStore
from cellctl.records.async_store import AsyncRunStore
from tests.unit.records.conftest import start

SHORT_S = 0.05
OLD = Path(__file__).parents[2] / "data" / "store-v2"


@pytest.fixture
def other_writer(tmp_path: Path) -> Iterator[sqlite3.Connection]:
    """Another program, with a store to write to; its ``BEGIN IMMEDIATE`` takes the lock."""
    RunStore(tmp_path).close()
    with closing(sqlite3.connect(tmp_path / "store.sqlite", check_same_thread=False)) as writer:
        yield writer


def test_a_store_that_was_locked_takes_the_next_write(
    tmp_path: Path, other_writer: sqlite3.Connection
) -> None:
    with closing(RunStore(tmp_path, lock_wait_s=SHORT_S)) as store:
        run = start(store)
        other_writer.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreLocked, match="locked"):
            store.note_line_seq(7)
        other_writer.rollback()
        assert store.line_seq() is None
        store.note_line_seq(8)
        store.close_run(run, RunResult.GOOD)
        assert store.line_seq() == 8
        assert store.verify() == []


async def test_a_lock_keeps_no_further_run_from_starting(
    tmp_path: Path, other_writer: sqlite3.Connection
) -> None:
    archive = AsyncRunStore(tmp_path, lock_wait_s=SHORT_S)
    other_writer.execute("BEGIN IMMEDIATE")
    with pytest.raises(StoreLocked):
        await archive.do(RunStore.note_line_seq, 7)
    assert archive.fault is None
    other_writer.rollback()
    await archive.do(RunStore.note_line_seq, 8)
    archive.close()


async def test_what_has_to_be_written_outlasts_the_lock(
    tmp_path: Path, other_writer: sqlite3.Connection
) -> None:
    archive = AsyncRunStore(tmp_path, lock_wait_s=SHORT_S)
    run = await archive.do(start)
    other_writer.execute("BEGIN IMMEDIATE")
    with capture_logs() as lines:
        close = asyncio.create_task(archive.insist(60.0, RunStore.close_run, run, RunResult.GOOD))
        while len(lines) < 2:  # as often as it was tried in vain
            await asyncio.wait({close}, timeout=SHORT_S)
        other_writer.rollback()
        await close
    assert (await archive.do(RunStore.run, run)).head.result == "good"
    other_writer.execute("BEGIN IMMEDIATE")
    with pytest.raises(StoreLocked):
        await archive.insist(SHORT_S / 2, RunStore.note_line_seq, 7)
    other_writer.rollback()
    archive.close()


async def test_a_write_waits_for_a_lock_that_is_given_back(
    tmp_path: Path, other_writer: sqlite3.Connection
) -> None:
    archive = AsyncRunStore(tmp_path)
    other_writer.execute("BEGIN IMMEDIATE")
    write = asyncio.create_task(archive.do(RunStore.note_line_seq, 7))
    await asyncio.wait({write}, timeout=SHORT_S)
    assert not write.done()
    other_writer.rollback()
    await write
    assert await archive.do(RunStore.line_seq) == 7
    archive.close()


def test_a_lock_keeps_an_older_store_from_being_migrated_and_says_so(tmp_path: Path) -> None:
    old = Path(copytree(OLD, tmp_path / "store"))
    with closing(sqlite3.connect(old / "store.sqlite")) as other_writer:
        other_writer.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreLocked):
            RunStore(old, lock_wait_s=SHORT_S)
    RunStore(old).close()
