"""Commands that a daemon which stood still finds in its sockets count from before that."""

import asyncio
import socket
import time
from pathlib import Path

import pytest

from cellctl.api.local_socket.messages import PlainCommand, to_line
from cellctl.api.local_socket.server import LocalServer
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.command.arrivals import DRAIN_S, HELD_S, ArrivalClock
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from tests.unit.api.local_socket.conftest import bench, rig
from tests.unit.api.local_socket.test_page import Page
from tests.unit.daemon_rig import DaemonRig

__all__ = ["bench", "rig"]


class Time:
    def __init__(self) -> None:
        self.s = 100.0

    def __call__(self) -> float:
        return self.s


def test_what_is_read_in_a_loop_that_turns_is_new() -> None:
    time_s = Time()
    clock = ArrivalClock(time_s)
    for _ in range(50):
        time_s.s += 0.9 * HELD_S
        assert clock.given_s() == time_s.s
        clock.turn()


@pytest.mark.parametrize("told", [False, True], ids=["before its timers", "after them"])
def test_what_is_read_after_a_stand_still_may_be_as_old_as_that(*, told: bool) -> None:
    time_s = Time()
    clock = ArrivalClock(time_s)
    time_s.s += 60.0
    if told:
        clock.turn()
    assert clock.given_s() == 100.0


def test_soon_after_a_stand_still_what_is_read_is_new_again() -> None:
    time_s = Time()
    clock = ArrivalClock(time_s)
    time_s.s += 60.0
    clock.turn()
    time_s.s += 0.9 * DRAIN_S
    clock.turn()
    assert clock.given_s() == 100.0, "its connection may have been accepted in a turn before"
    time_s.s += 0.2 * DRAIN_S
    assert clock.given_s() == time_s.s


@pytest.mark.parametrize("stood_still", [False, True])
async def test_a_command_of_the_page_may_have_waited_since_before_a_stop(
    rig: DaemonRig, tmp_path: Path, *, stood_still: bool
) -> None:
    clock = ArrivalClock(held_s=0.2)
    page = Page(rig, given_s=clock.given_s)

    async def nobody_follows(_writer: asyncio.StreamWriter) -> None:
        raise AssertionError

    path = tmp_path / "s"
    server = LocalServer(SocketFile(path, ""), page.ask, nobody_follows)  # type: ignore[arg-type]
    await server.start()
    clock.turn()
    # In Stopped there is nothing to stop: no state changes that a person could have decided upon.
    await page.ask(page.wanted(PlainCommand(request="stop")))
    refused = len(rig.unit.machine.refusals)
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(str(path))
        connection.sendall(to_line(page.wanted(PlainCommand(request="reset"))))
        if stood_still:
            time.sleep(0.4)  # noqa: ASYNC251 - the daemon stands still
        else:
            clock.turn()
        await rig.until(lambda: len(rig.unit.machine.refusals) > refused or bool(rig.states))
    await server.stop()
    if stood_still:
        assert rig.states == []
        assert rig.unit.machine.refusals[-1].code is RejectCode.SUPERSEDED
    else:
        await rig.to(State.IDLE)
