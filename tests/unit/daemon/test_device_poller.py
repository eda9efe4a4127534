"""Heads, tracker and vision workers while nothing runs."""

import asyncio

import pytest

from cellctl.daemon.device_poller import DevicePoller
from cellctl.errors import CellError
from cellctl.errors.link import DeviceAway
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from tests.unit.daemon_rig import DaemonRig


def poller(rig: DaemonRig) -> DevicePoller:
    return DevicePoller(rig.bench.as_cell, rig.unit)


async def test_a_head_that_is_away_refuses_a_start_until_it_is_back(rig: DaemonRig) -> None:
    await rig.idle()
    polled = poller(rig)
    camera = rig.bench.cell.head_2.camera
    await polled.ask()
    assert rig.shown().ready
    await camera.disconnect()
    await polled.ask()
    await polled.ask()
    assert rig.unit.machine.state is State.IDLE
    assert (rig.shown().alarms, rig.shown().ready) == ((209,), False)
    assert await rig.take(Command.START) is RejectCode.DEVICE_NOT_READY
    await camera.connect()
    await polled.ask()
    assert rig.shown().ready


async def test_a_dead_vision_worker_aborts_and_clear_replaces_it(rig: DaemonRig) -> None:
    await rig.idle()
    polled = poller(rig)
    rig.bench.cell.workers.died = True
    await polled.ask()
    await rig.to(State.ABORTED)
    await polled.ask()
    assert rig.shown().first_out_alarm == 902
    await rig.idle()
    await polled.ask()
    assert rig.unit.machine.state is State.IDLE


async def test_nobody_is_asked_in_a_run_or_before_all_are_connected(rig: DaemonRig) -> None:
    polled = poller(rig)
    rig.bench.cell.workers.died = True
    rig.bench.cell.connected = False
    await polled.ask()
    rig.bench.cell.connected = True
    rig.contact.may_end.clear()
    await rig.started()
    await asyncio.wait_for(rig.contact.reached.wait(), 10)
    rig.bench.cell.workers.died = True
    await polled.ask()
    assert rig.unit.machine.state is State.EXECUTE
    rig.contact.may_end.set()
    await rig.to(State.COMPLETED)


async def test_what_is_away_is_told_anew_after_a_clear(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.idle()
    told: list[CellError] = []

    async def note(fault: CellError) -> None:
        told.append(fault)

    monkeypatch.setattr(rig.unit.machine, "fail", note)
    polled = poller(rig)
    await rig.bench.cell.head_2.camera.disconnect()
    await polled.ask()
    await polled.ask()
    assert [type(fault) for fault in told] == [DeviceAway]
    rig.bench.cell.connected = False
    await polled.ask()
    rig.bench.cell.connected = True
    await polled.ask()
    assert [type(fault) for fault in told] == [DeviceAway, DeviceAway]
