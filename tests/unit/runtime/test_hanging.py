"""What never answers leads to a fault and to a state in which nothing moves: no unit waits on."""

import asyncio
import shutil
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from cellctl.cell.time_limits import TimeLimits
from cellctl.daemon.device_poller import DevicePoller
from cellctl.errors.link import DeviceAway
from cellctl.errors.records.store import DiskNearlyFull, RecordSilent
from cellctl.errors.robot import StopFailed
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import WAIT_S, DaemonRig

SHORT_S = 0.05


async def hang() -> None:
    await asyncio.Event().wait()


class HangingDisk:
    """Takes a write and does not answer until the test lets it."""

    def __init__(self) -> None:
        self._asked = threading.Event()
        self._answers = threading.Event()

    def hold(self) -> None:
        """Called by the store's thread in place of the disk."""
        self._asked.set()
        self._answers.wait()

    async def asked(self) -> None:
        """Wait until the write hangs: on a busy PC its time may be up before it has begun."""
        assert await asyncio.to_thread(self._asked.wait, WAIT_S)

    def answer(self) -> None:
        self._answers.set()


@pytest.fixture
def disk() -> Iterator[HangingDisk]:
    disk = HangingDisk()
    yield disk
    disk.answer()


async def test_a_driver_that_hangs_in_its_stop(rig: DaemonRig) -> None:
    rig.bench.cell.time_limits = TimeLimits(stop_s=SHORT_S)
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    rig.bench.cell.aux_1.stop = hang  # type: ignore[method-assign]
    await rig.take(Command.STOP)
    await rig.to(State.ABORTED)
    assert StopFailed.number in rig.shown().alarms
    assert rig.bench.cell.main.latched, "the others were stopped"
    assert (await rig.record()).head.result == "stopped"


async def test_a_disk_that_hangs_when_the_run_is_closed(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch, disk: HangingDisk
) -> None:
    rig.bench.cell.time_limits = TimeLimits(close_record_s=SHORT_S)
    await rig.restart()
    closes = RunStore.close_run

    def slow(store: RunStore, *args: object, **fields: object) -> None:
        disk.hold()
        closes(store, *args, **fields)  # type: ignore[arg-type]

    monkeypatch.setattr(RunStore, "close_run", slow)
    seq = await rig.started()
    await rig.to(State.ABORTED)
    assert rig.shown().first_out_alarm == RecordSilent.number
    assert rig.port.ended[seq] is not Result.GOOD
    await disk.asked()
    disk.answer()
    assert (await rig.record()).head.result == "good", "the part itself was"
    assert rig.shown().run_result is Result.ABORTED, "what the line was told stays"
    await rig.restart()
    assert rig.shown().run_result is Result.ABORTED, "over a restart, too"


async def test_a_disk_that_hangs_when_the_run_is_opened(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch, disk: HangingDisk
) -> None:
    rig.bench.cell.time_limits = TimeLimits(open_record_s=SHORT_S, close_record_s=SHORT_S)
    await rig.restart()
    await rig.idle()
    starts = RunStore.start_run

    def slow(store: RunStore, **fields: Any) -> int:
        disk.hold()
        return starts(store, **fields)

    monkeypatch.setattr(RunStore, "start_run", slow)
    await rig.take(Command.START)
    await rig.to(State.ABORTED)
    assert rig.shown().first_out_alarm == RecordSilent.number
    assert not any(robot.moves for robot in rig.bench.cell.robots.values())
    await disk.asked()
    disk.answer()
    async with asyncio.timeout(WAIT_S):
        # Completed late, and closed then; each look waits for its turn behind that.
        while (await rig.record()).head.result != "aborted":
            pass
    assert not rig.bench.cell.robot_notes.listeners


async def test_a_device_that_hangs_when_it_is_asked(rig: DaemonRig) -> None:
    rig.bench.cell.time_limits = TimeLimits(ask_s=SHORT_S)
    await rig.idle()
    rig.bench.cell.head_2.camera.serial_number = hang  # type: ignore[assignment, method-assign]
    await DevicePoller(rig.bench.as_cell, rig.unit).ask()
    assert rig.shown().alarms == (DeviceAway.number,)
    assert not rig.shown().ready


async def test_a_disk_without_room_refuses_the_start(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = shutil.disk_usage("/")._replace(free=10**6)
    await rig.idle()
    monkeypatch.setattr(shutil, "disk_usage", lambda _folder: full)
    assert await rig.take(Command.START) is RejectCode.RECORDS_NOT_READY
    assert rig.unit.machine.state is State.IDLE
    assert not rig.shown().ready
    monkeypatch.undo()
    assert await rig.take(Command.START) is RejectCode.NONE, "taken as soon as there is room"


async def test_a_disk_that_fills_up_after_start_ends_the_run_before_anything_moves(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = shutil.disk_usage("/")
    free = iter([there.total])
    monkeypatch.setattr(
        shutil, "disk_usage", lambda _folder: there._replace(free=next(free, 10**6))
    )
    await rig.idle()
    moves = list(rig.bench.cell.main.moves)
    assert await rig.take(Command.START) is RejectCode.NONE
    await rig.until(lambda: rig.shown().first_out_alarm == DiskNearlyFull.number)
    await rig.to(State.STOPPED)
    assert rig.bench.cell.main.moves == moves, "nothing has moved"
    assert not await rig.runs()
