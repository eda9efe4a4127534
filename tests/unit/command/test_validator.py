"""What a command meets before it is executed, check by check."""

import asyncio
import math
from dataclasses import dataclass
from typing import Any, cast

import pytest

from cellctl.clock import now_s
from cellctl.command.submission import Submission
from cellctl.command.validator import CommandValidator, validate_parameters
from cellctl.packml import Command, PackMLMachine, RejectCode, State
from cellctl.packml.command import COMMANDS
from cellctl.packml.unit_command import MOST_AGE_S, Source, UnitCommand
from cellctl.runtime.jobs.factory import JobFactory
from cellctl.runtime.unit import MAY_MOVE
from tests.unit.cell.bench import start_command
from tests.unit.daemon_rig import BY_ANNA, DaemonRig


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({}, RejectCode.NONE),
        ({"serial": ""}, RejectCode.SERIAL_INVALID),
        ({"serial": "sat-1"}, RejectCode.SERIAL_INVALID),
        ({"serial": "SAT 1"}, RejectCode.SERIAL_INVALID),
        ({"serial": "SAT\ufffd"}, RejectCode.SERIAL_INVALID),
        ({"order": "a/b"}, RejectCode.ORDER_INVALID),
        ({"options": 4}, RejectCode.OPTIONS_UNKNOWN),
        ({"serial": "", "cntrl_cmd": Command.RESET}, RejectCode.NONE),
        ({"serial": "???", "options": 99, "cntrl_cmd": Command.STOP}, RejectCode.NONE),
        ({"serial": "???", "options": 99, "cntrl_cmd": Command.ABORT}, RejectCode.NONE),
    ],
)
def test_parameters_are_validated(change: dict[str, Any], code: RejectCode) -> None:
    assert validate_parameters(start_command(**change)) is code


@dataclass(frozen=True, slots=True, eq=False)
class DeadLink(Submission):
    def link_fault(self) -> RejectCode:
        return RejectCode.LINE_HEARTBEAT_MISSING


async def test_of_several_reasons_the_first_one_is_answered(rig: DaemonRig) -> None:
    """Link, parameters, turn, authority, disk, start, tables: each is mended in turn."""
    await rig.idle()
    rig.port.line_alive = True
    (rig.bench.calibrations.path / "head_1.json").unlink()
    wrong: dict[str, Any] = {
        **BY_ANNA, "serial": "?", "order": "?", "options": 4, "recipe_id": 9, "unit_mode": 9,
        "alarm_ack_id": 9, "arrived_s": -math.inf,
    }  # fmt: skip

    async def answer(**mended: Any) -> RejectCode:
        wrong.update(mended)
        return await rig.submit(start_command(**wrong))

    dead = DeadLink(start_command(**wrong))
    assert await rig.arbiter.submit(dead) is RejectCode.LINE_HEARTBEAT_MISSING
    assert await answer() is RejectCode.SERIAL_INVALID
    assert await answer(serial="S") is RejectCode.ORDER_INVALID
    assert await answer(order="O") is RejectCode.OPTIONS_UNKNOWN
    assert await answer(options=0) is RejectCode.SUPERSEDED
    assert await answer(arrived_s=now_s()) is RejectCode.LINE_IN_CONTROL
    rig.port.line_alive = False
    assert await answer() is RejectCode.ALARM_UNKNOWN
    assert await answer(alarm_ack_id=0) is RejectCode.MODE_NOT_CONFIGURED
    assert await answer(unit_mode=1) is RejectCode.RECIPE_UNKNOWN
    assert await answer(recipe_id=1) is RejectCode.CALIBRATION_INVALID
    assert rig.unit.machine.state is State.IDLE


async def test_a_client_with_a_dead_link_may_still_stop(rig: DaemonRig) -> None:
    await rig.idle()
    stop = DeadLink(start_command(cntrl_cmd=Command.STOP))
    assert await rig.arbiter.submit(stop) is RejectCode.NONE
    await rig.to(State.STOPPED)


async def test_a_validation_gives_way_to_the_stop_behind_it(
    rig: DaemonRig,
) -> None:
    """The disk does not answer, and the Stop must not wait until that is a fault."""
    stop_waits, disk = asyncio.Event(), asyncio.Event()

    @dataclass(frozen=True, slots=True, eq=False)
    class Behind(Submission):
        async def remember(self) -> None:
            stop_waits.set()
            await disk.wait()

        async def overtaken(self) -> None:
            await stop_waits.wait()

    reset = Behind(start_command(cntrl_cmd=Command.RESET))
    async with asyncio.timeout(1):
        assert await rig.arbiter.submit(reset) is RejectCode.SUPERSEDED
    assert rig.unit.machine.state is State.STOPPED
    assert rig.shown().alarms == ()


@pytest.mark.parametrize("source", list(Source))
@pytest.mark.parametrize("command", list(COMMANDS))
def test_what_may_move_a_robot_is_not_begun_long_after_it_was_given(
    source: Source, command: Command
) -> None:
    """A daemon that stood still finds it in its sockets when nobody waits for an answer."""
    machine = PackMLMachine({})
    validator = CommandValidator(machine, cast(JobFactory, None), lambda: False)
    now = now_s()
    young = UnitCommand(source, cntrl_cmd=command, arrived_s=now - MOST_AGE_S + 1.0)
    assert validator.validate_turn(young) is RejectCode.NONE
    old = UnitCommand(source, cntrl_cmd=command, arrived_s=now - MOST_AGE_S - 0.1)
    late = RejectCode.SUPERSEDED if command in MAY_MOVE else RejectCode.NONE
    assert validator.validate_turn(old) is late
