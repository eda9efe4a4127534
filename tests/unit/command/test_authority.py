"""Line and terminal share the cell: who may command when, and what neither may overtake."""

import asyncio
from datetime import timedelta
from itertools import product
from typing import Any

import pytest

from cellctl.clock import now_s
from cellctl.command.validator import validate_authority
from cellctl.errors.link import LinkLost
from cellctl.packml.command import Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.packml.unit_command import Source
from cellctl.records.store import RunStore
from tests.unit.calibration.store.shipped import renew_calibrations
from tests.unit.cell.bench import start_command
from tests.unit.command.test_arbiter import audit
from tests.unit.daemon_rig import BY_ANNA, DaemonRig

BY_LINE: dict[str, Any] = {"source": Source.LINE}
IN_CONTROL = RejectCode.LINE_IN_CONTROL
ANYBODYS = {Command.UNDEFINED, Command.STOP, Command.ABORT, Command.HOLD, Command.SUSPEND}
ANYBODYS |= {Command.CLEAR, Command.COMPLETE}


@pytest.mark.parametrize("command", Command)
def test_the_line_alone_moves_the_cell_in_production(command: Command) -> None:
    asked = start_command(cntrl_cmd=command, unit_mode=0, **BY_ANNA)
    code = validate_authority(asked, Mode.PRODUCTION, line_alive=True)
    assert (code is RejectCode.NONE) == (command in ANYBODYS)
    assert validate_authority(asked, Mode.PRODUCTION, line_alive=False) is RejectCode.NONE
    assert validate_authority(asked, Mode.MAINTENANCE, line_alive=True) is RejectCode.NONE


@pytest.mark.parametrize(
    ("mode", "wanted", "command", "code"),
    [
        (Mode.PRODUCTION, Mode.MAINTENANCE, Command.UNDEFINED, IN_CONTROL),
        (Mode.PRODUCTION, Mode.MAINTENANCE, Command.START, IN_CONTROL),
        (Mode.PRODUCTION, Mode.PRODUCTION, Command.UNDEFINED, RejectCode.NONE),
        (Mode.MAINTENANCE, Mode.PRODUCTION, Command.UNDEFINED, RejectCode.NONE),
        (Mode.MAINTENANCE, Mode.PRODUCTION, Command.START, IN_CONTROL),
        (Mode.MAINTENANCE, Mode.MAINTENANCE, Command.START, RejectCode.NONE),
        (Mode.MANUAL, Mode.MAINTENANCE, Command.UNDEFINED, RejectCode.NONE),
    ],
)
def test_the_line_gives_control_away_and_nobody_takes_it(
    mode: Mode, wanted: Mode, command: Command, code: RejectCode
) -> None:
    asked = start_command(cntrl_cmd=command, unit_mode=wanted, **BY_ANNA)
    assert validate_authority(asked, mode, line_alive=True) is code


def test_the_line_needs_nobodys_leave() -> None:
    for mode, command in product(Mode, Command):
        asked = start_command(cntrl_cmd=command)
        assert validate_authority(asked, mode, line_alive=True) is RejectCode.NONE


async def test_a_cell_without_a_line_is_run_from_the_terminal(rig: DaemonRig) -> None:
    await rig.unit.machine.command(Command.ABORT)
    await rig.to(State.ABORTED)
    assert await rig.ask(Command.CLEAR) is RejectCode.NONE
    await rig.to(State.STOPPED)
    assert await rig.ask(Command.RESET) is RejectCode.NONE
    await rig.to(State.IDLE)
    assert await rig.ask(Command.START, unit_mode=1, serial="SAT-9") is RejectCode.NONE
    await rig.to(State.COMPLETED)
    head = (await rig.record()).head
    assert (head.serial, head.operator, head.result) == ("SAT-9", "terminal:anna", "good")
    entries = await rig.archive.do(audit)
    assert [(actor, action) for actor, action, _ in entries] == [
        ("terminal:anna", "clear"),
        ("terminal:anna", "reset"),
        ("terminal:anna", "start"),
    ]
    assert "seq" not in entries[0][2]
    assert await rig.archive.do(RunStore.line_seq) is None


async def test_a_mode_that_was_changed_meanwhile_is_not_started_in(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The change comes between validation and execution."""
    await rig.idle()
    factory = rig.unit.factory
    validate = factory.validate

    async def slow(*asked: object) -> RejectCode:
        await rig.unit.machine.set_mode(Mode.MAINTENANCE)
        return await validate(*asked)  # type: ignore[arg-type]

    monkeypatch.setattr(factory, "validate", slow)
    assert await rig.ask(Command.START, in_mode=1) is RejectCode.OTHER_MODE
    assert rig.unit.machine.state is State.IDLE


@pytest.mark.parametrize("mode", [Mode.PRODUCTION, Mode.MAINTENANCE])
def test_a_start_that_names_its_mode_is_the_lines_where_either_is_production(mode: Mode) -> None:
    wanted = Mode.MAINTENANCE if mode is Mode.PRODUCTION else Mode.PRODUCTION
    asked = start_command(unit_mode=0, in_mode=wanted, **BY_ANNA)
    assert validate_authority(asked, mode, line_alive=True) is IN_CONTROL


async def test_the_terminals_commands_meet_the_same_checks(rig: DaemonRig) -> None:
    rig.bench.cell.connected = False
    assert await rig.ask(Command.RESET) is RejectCode.DEVICE_NOT_READY
    rig.bench.cell.connected = True
    assert await rig.ask(Command.CLEAR) is RejectCode.COMMAND_NOT_ALLOWED
    await rig.idle()
    assert await rig.ask(Command.START, recipe_id=99) is RejectCode.RECIPE_UNKNOWN
    renew_calibrations(rig.bench.calibrations.path, timedelta(minutes=10))
    assert await rig.ask(Command.START) is RejectCode.CALIBRATION_INVALID
    rig.bench.cell.aux_1.looks["emergency_stop"] = True
    assert await rig.ask(Command.START, unit_mode=2, recipe_id=103) is RejectCode.DEVICE_NOT_READY
    assert await rig.ask(Command.UNDEFINED, alarm_ack_id=501) is RejectCode.ALARM_UNKNOWN
    assert rig.unit.machine.state is State.IDLE


async def test_beside_a_living_line_the_terminal_ends_motion_only(rig: DaemonRig) -> None:
    rig.port.line_alive = True
    assert await rig.ask(Command.RESET) is IN_CONTROL
    assert await rig.ask(Command.UNDEFINED, unit_mode=2) is IN_CONTROL
    rig.contact.may_end.clear()
    seq = await rig.started()
    await rig.contact.reached.wait()
    assert await rig.ask(Command.ABORT) is RejectCode.NONE
    await rig.to(State.ABORTED)
    assert rig.port.ended[seq] is Result.ABORTED, "the line is told how its Start has ended"
    assert await rig.ask(Command.CLEAR) is RejectCode.NONE
    await rig.to(State.STOPPED)
    assert await rig.ask(Command.RESET) is IN_CONTROL


async def test_an_alarm_is_acknowledged_in_the_name_of_who_asks(rig: DaemonRig) -> None:
    rig.port.line_alive = True
    await rig.idle()
    await rig.unit.machine.fail(LinkLost("aux_1"))
    await rig.to(State.ABORTED)
    await rig.unit.background.drain()
    assert await rig.ask(Command.UNDEFINED, alarm_ack_id=202) is RejectCode.NONE
    await rig.unit.background.drain()
    assert (await rig.archive.do(audit))[-1][0] == "terminal:anna"
    assert await rig.archive.do(RunStore.active_alarms) == []


async def test_a_line_that_comes_alive_meanwhile_keeps_the_terminal_from_moving(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The change comes between validation and execution."""
    await rig.idle()
    factory = rig.unit.factory
    validate = factory.validate

    async def slow(*asked: object) -> RejectCode:
        rig.port.line_alive = True
        return await validate(*asked)  # type: ignore[arg-type]

    monkeypatch.setattr(factory, "validate", slow)
    assert await rig.ask(Command.START) is IN_CONTROL
    assert rig.unit.machine.state is State.IDLE


@pytest.mark.parametrize("stop", [Command.STOP, Command.ABORT])
@pytest.mark.parametrize(
    ("one", "other"), [(BY_LINE, BY_ANNA), (BY_ANNA, BY_LINE)], ids=["line", "anna"]
)
async def test_nobodys_command_survives_a_stop_that_came_after_it(
    rig: DaemonRig, stop: Command, one: Any, other: Any
) -> None:
    early = start_command(cntrl_cmd=Command.RESET, unit_mode=0, **one)
    await rig.submit(start_command(cntrl_cmd=stop, **other))
    if stop is Command.ABORT:
        await rig.to(State.ABORTED)
        assert await rig.take(Command.CLEAR) is RejectCode.NONE
        await rig.to(State.STOPPED)
    assert await rig.submit(early) is RejectCode.SUPERSEDED
    assert rig.unit.machine.state is State.STOPPED
    assert await rig.take(Command.RESET) is RejectCode.NONE


async def test_what_the_line_gives_after_its_stop_is_executed_after_it(rig: DaemonRig) -> None:
    stop = start_command(cntrl_cmd=Command.STOP)
    reset = start_command(cntrl_cmd=Command.RESET, unit_mode=0)
    await rig.submit(stop)
    assert await rig.submit(reset) is RejectCode.NONE


@pytest.mark.parametrize(
    ("one", "other"), [(BY_LINE, BY_ANNA), (BY_ANNA, BY_LINE)], ids=["line", "anna"]
)
async def test_a_command_given_before_the_others_is_not_executed_after_it(
    rig: DaemonRig, one: Any, other: Any
) -> None:
    early = start_command(cntrl_cmd=Command.RESET, unit_mode=0, arrived_s=now_s(), **one)
    later = start_command(cntrl_cmd=0, unit_mode=2, **other)
    assert await rig.submit(later) is RejectCode.NONE
    assert await rig.submit(early) is RejectCode.SUPERSEDED


async def test_two_starts_at_once_begin_the_one_that_was_taken(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both are validated in Idle; the refused one must not leave its order behind."""
    await rig.idle()
    factory, both = rig.unit.factory, asyncio.Barrier(2)
    validate = factory.validate

    async def together(*asked: object) -> RejectCode:
        code = await validate(*asked)  # type: ignore[arg-type]
        await both.wait()
        return code

    monkeypatch.setattr(factory, "validate", together)
    codes = await asyncio.gather(
        rig.ask(Command.START, serial="TERMINAL.1"), rig.take(Command.START, serial="LINE.1")
    )
    assert sorted(codes)[0] is RejectCode.NONE
    assert sorted(codes)[1] is RejectCode.SUPERSEDED
    await rig.to(State.COMPLETED)
    serial = "TERMINAL.1" if codes[0] is RejectCode.NONE else "LINE.1"
    assert [head.serial for head in await rig.runs()] == [serial]
