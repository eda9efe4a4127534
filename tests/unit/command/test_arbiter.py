"""What the line may ask for, and what becomes of its numbers and alarms."""

import asyncio
import threading
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

import pytest

from cellctl.errors.force import SensorSilent
from cellctl.errors.link import LinkLost
from cellctl.errors.records.store import RecordNotWritten
from cellctl.packml.command import Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.records.store import RunStore
from tests.unit.calibration.store.shipped import renew_calibrations
from tests.unit.cell.bench import start_command
from tests.unit.daemon_rig import DaemonRig, RigSubmission


def audit(store: RunStore) -> list[tuple[str, str, dict[str, Any]]]:
    return [(entry.actor, entry.action, dict(entry.detail)) for entry in store.audit_log()]


@pytest.mark.parametrize(
    ("fields", "code"),
    [
        ({"recipe_id": 99}, RejectCode.RECIPE_UNKNOWN),
        ({"unit_mode": 2, "recipe_id": 1}, RejectCode.RECIPE_UNKNOWN),
        ({"unit_mode": 2, "recipe_id": 103, "options": 1}, RejectCode.OPTIONS_UNKNOWN),
        ({"unit_mode": 3, "recipe_id": 1}, RejectCode.STATE_NOT_IN_MODE),
        ({"unit_mode": 9}, RejectCode.MODE_NOT_CONFIGURED),
        ({"unit_mode": 77}, RejectCode.MODE_UNDEFINED),
    ],
)
async def test_a_start_is_refused_with_its_reason(
    rig: DaemonRig, fields: dict[str, int], code: RejectCode
) -> None:
    await rig.idle()
    assert await rig.take(Command.START, **fields) is code
    assert rig.unit.machine.state is State.IDLE
    assert rig.unit.jobs.shown is None


async def test_an_expiring_calibration_refuses_production_only(rig: DaemonRig) -> None:
    await rig.idle()
    assert rig.shown().ready
    renew_calibrations(rig.bench.calibrations.path, timedelta(minutes=10))
    assert not rig.shown().ready
    assert rig.shown().calibration_ok
    assert await rig.take(Command.START) is RejectCode.CALIBRATION_INVALID
    assert await rig.take(Command.UNDEFINED, unit_mode=2) is RejectCode.NONE
    assert rig.shown().ready


async def test_devices_that_are_not_ready_refuse_a_start(rig: DaemonRig) -> None:
    await rig.idle()
    assert rig.shown().ready
    rig.bench.cell.aux_1.looks["emergency_stop"] = True
    assert not rig.shown().ready
    assert await rig.take(Command.START) is RejectCode.DEVICE_NOT_READY
    rig.bench.cell.aux_1.looks.clear()
    rig.bench.cell.guard.faults["check"] = SensorSilent("2 s")
    assert not rig.shown().ready
    assert await rig.take(Command.START) is RejectCode.DEVICE_NOT_READY
    rig.bench.cell.guard.faults.clear()
    assert await rig.take(Command.START) is RejectCode.NONE
    await rig.to(State.COMPLETED)


async def test_nothing_moves_before_the_devices_are_connected(rig: DaemonRig) -> None:
    rig.bench.cell.connected = False
    assert await rig.take(Command.RESET) is RejectCode.DEVICE_NOT_READY
    rig.bench.cell.connected = True
    assert await rig.take(Command.RESET) is RejectCode.NONE


async def test_the_number_is_noted_before_anything_moves(rig: DaemonRig) -> None:
    await rig.idle()
    assert await rig.archive.do(RunStore.line_seq) == rig._seq
    await rig.take(Command.STOP)
    await rig.unit.background.drain()
    assert await rig.archive.do(RunStore.line_seq) == rig._seq
    assert rig._seq == 2


async def test_a_number_that_cannot_be_noted_stops_motion_but_not_stop(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise RecordNotWritten("disk full")

    await rig.idle()
    monkeypatch.setattr(RunStore, "note_line_seq", full)
    assert await rig.take(Command.START) is RejectCode.RECORDS_NOT_READY
    assert rig.unit.machine.state is State.IDLE
    assert await rig.take(Command.STOP) is RejectCode.NONE
    await rig.to(State.STOPPED)


async def test_a_disk_that_hangs_refuses_what_may_move_and_holds_nothing_up(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = threading.Event()
    monkeypatch.setattr(RunStore, "note_line_seq", lambda *_: disk.wait(10))
    rig.arbitrate(disk_timeout_s=0.05)
    try:
        assert await rig.take(Command.RESET) is RejectCode.RECORDS_NOT_READY
        assert rig.unit.machine.state is State.STOPPED
        assert rig.shown().alarms == (809,)
        assert await rig.take(Command.ABORT) is RejectCode.NONE
        await rig.to(State.ABORTED)
    finally:
        disk.set()


async def test_an_answer_comes_after_its_audit_line_but_a_stop_waits_for_nothing(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk, write = threading.Event(), RunStore.audit

    def slow(store: RunStore, *entry: Any) -> None:
        assert disk.wait(10)
        write(store, *entry)

    monkeypatch.setattr(RunStore, "audit", slow)
    try:
        answer = asyncio.create_task(rig.take(Command.RESET))
        await rig.to(State.IDLE)
        assert not answer.done(), "executed, but not answered before it is on record"
        assert await asyncio.wait_for(rig.take(Command.STOP), 1.0) is RejectCode.NONE
        await rig.to(State.STOPPED)
        assert not answer.done()
    finally:
        disk.set()
    assert await answer is RejectCode.NONE
    await rig.unit.background.drain()
    actions = [action for _, action, _ in await rig.archive.do(audit)]
    assert sorted(actions) == ["reset", "stop"]


@dataclass(frozen=True, slots=True, eq=False)
class WithStopBehind(RigSubmission):
    """Its client has given a Stop that waits for it."""

    async def overtaken(self) -> None:
        await self.rig.to(State.IDLE)


async def test_a_stop_behind_a_command_does_not_wait_for_its_audit_line(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk, write = threading.Event(), RunStore.audit

    def slow(store: RunStore, *entry: Any) -> None:
        assert disk.wait(10)
        write(store, *entry)

    monkeypatch.setattr(RunStore, "audit", slow)
    reset = start_command(cntrl_cmd=Command.RESET)
    submission = WithStopBehind(reset, 7, rig)
    try:
        assert await asyncio.wait_for(rig.arbiter.submit(submission), 1.0) is RejectCode.NONE
    finally:
        disk.set()
    await rig.archive.do(RunStore.runs)
    assert [action for _, action, _ in await rig.archive.do(audit)] == ["reset"], "written anyway"


async def test_a_disk_that_takes_no_audit_line_delays_no_answer_for_long(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = threading.Event()
    monkeypatch.setattr(RunStore, "audit", lambda *_: disk.wait(10))
    rig.arbitrate(disk_timeout_s=0.3)
    try:
        assert await asyncio.wait_for(rig.take(Command.RESET), 2.0) is RejectCode.NONE
        assert rig.shown().alarms == (809,)
    finally:
        disk.set()


async def test_alarms_live_until_they_are_acknowledged(rig: DaemonRig) -> None:
    await rig.idle()
    await rig.unit.machine.fail(LinkLost("aux_1"))
    await rig.to(State.ABORTED)
    assert (rig.shown().alarms, rig.shown().error, rig.shown().warning) == ((202,), True, False)
    await rig.idle()
    status = rig.shown()
    assert (status.alarms, status.error, status.warning) == ((202,), False, True)
    assert status.first_out_alarm == 0
    await rig.restart()
    assert rig.shown().alarms == (202,)

    assert await rig.take(Command.UNDEFINED, alarm_ack_id=501) is RejectCode.ALARM_UNKNOWN
    assert await rig.take(Command.UNDEFINED, alarm_ack_id=202, order="OP-3") is RejectCode.NONE
    assert rig.port.ended[rig._seq] is Result.GOOD
    assert (rig.shown().alarms, rig.shown().warning) == ((), False)
    assert await rig.archive.do(RunStore.active_alarms) == []
    await rig.unit.background.drain()
    last = await rig.archive.do(audit)
    assert (last[-1][0], last[-1][2]["order"]) == ("line", "OP-3")
    assert last[-1][2]["acknowledged"] == 202


async def test_a_latched_fault_stays_though_it_is_acknowledged(rig: DaemonRig) -> None:
    await rig.idle()
    await rig.unit.machine.fail(LinkLost("aux_1"))
    await rig.to(State.ABORTED)
    assert await rig.take(Command.UNDEFINED, alarm_ack_id=202) is RejectCode.NONE
    assert (rig.shown().alarms, rig.shown().error) == ((202,), True)
    await rig.idle()
    assert rig.shown().alarms == ()


async def test_stop_is_executed_whatever_else_it_asks_for(rig: DaemonRig) -> None:
    await rig.idle()
    assert await rig.take(Command.STOP, alarm_ack_id=999, unit_mode=77) is RejectCode.NONE
    await rig.to(State.STOPPED)


async def test_the_mode_changes_without_a_command(rig: DaemonRig) -> None:
    for _ in range(2):
        assert await rig.take(Command.UNDEFINED, unit_mode=3) is RejectCode.NONE
        assert rig.port.ended[rig._seq] is Result.GOOD
    assert rig.unit.machine.mode is Mode.MANUAL
    assert await rig.take(Command.UNDEFINED, unit_mode=0) is RejectCode.COMMAND_UNDEFINED


async def test_nothing_is_armed_or_moved_in_manual(rig: DaemonRig) -> None:
    assert await rig.take(Command.RESET, unit_mode=3) is RejectCode.STATE_NOT_IN_MODE
    assert rig.unit.machine.mode is Mode.PRODUCTION
    await rig.idle()
    assert await rig.take(Command.STOP) is RejectCode.NONE
    await rig.to(State.STOPPED)
    moves = len(rig.bench.cell.main.moves)
    assert await rig.take(Command.UNDEFINED, unit_mode=3) is RejectCode.NONE
    assert await rig.take(Command.RESET) is RejectCode.STATE_NOT_IN_MODE
    assert rig.bench.cell.main.latched
    assert len(rig.bench.cell.main.moves) == moves
    assert not rig.shown().ready


async def test_what_was_commanded_is_in_the_audit_log(rig: DaemonRig) -> None:
    await rig.started(serial="SAT-9", order="OP-3")
    await rig.to(State.COMPLETED)
    await rig.unit.background.drain()
    entries = await rig.archive.do(audit)
    assert [(actor, action) for actor, action, _ in entries] == [
        ("line", "reset"),
        ("line", "start"),
    ]
    assert entries[1][2]["order"] == "OP-3", "an order is no person"
    assert entries[1][2]["serial"] == "SAT-9"


async def test_what_the_line_is_refused_is_in_the_audit_log(rig: DaemonRig) -> None:
    await rig.idle()
    assert await rig.take(Command.START, recipe_id=99) is RejectCode.RECIPE_UNKNOWN
    assert await rig.take(Command.UNDEFINED, unit_mode=77) is RejectCode.MODE_UNDEFINED
    assert await rig.take(Command.ABORT) is RejectCode.NONE
    await rig.to(State.ABORTED)
    assert await rig.take(Command.STOP) is RejectCode.COMMAND_NOT_ALLOWED
    await rig.unit.background.drain()
    noted = [(action, detail) for _, action, detail in await rig.archive.do(audit)]
    refused = [(action, detail) for action, detail in noted if "refused" in detail]
    assert [(action, detail["reject_code"]) for action, detail in refused] == [
        ("start", RejectCode.RECIPE_UNKNOWN),
        ("set", RejectCode.MODE_UNDEFINED),
        ("stop", RejectCode.COMMAND_NOT_ALLOWED),
    ]
    assert (refused[0][1]["recipe"], refused[0][1]["seq"]) == (99, 2)
    assert refused[1][1]["mode"] == "77"
