"""Commands that a daemon which stood still finds in its sockets count from before that."""

import asyncio
import socket
import time
from pathlib import Path

import pytest

from cellctl.api.local_socket.messages import PlainCommand, to_line
from cellctl.api.local_socket.server import LocalServer
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.command import arrivals, validator
from cellctl.command.arrivals import DRAIN_S, HELD_S, ArrivalClock
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
async def test_a_command_of_the_page_that_has_waited_too_long_moves_nothing(
    rig: DaemonRig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, stood_still: bool
) -> None:
    """The page has told its person long ago that nobody answers."""
    monkeypatch.setattr(arrivals, "HELD_S", 0.2)
    monkeypatch.setattr(validator, "MOST_AGE_S", 0.4)
    clock = ArrivalClock()
    page = Page(rig, given_s=clock.given_s)

    async def turn() -> None:
        while True:
            clock.turn()
            await asyncio.sleep(0.01)

    async def nobody_follows(_writer: asyncio.StreamWriter) -> None:
        raise AssertionError

    path = tmp_path / "s"
    server = LocalServer(SocketFile(path, ""), page.ask, nobody_follows)  # type: ignore[arg-type]
    await server.start()
    turning = asyncio.create_task(turn())
    await asyncio.sleep(0.05)
    wanted = page.wanted(PlainCommand(request="reset"))
    reader = socket.socket(socket.AF_UNIX)
    with reader:
        reader.connect(str(path))
        reader.sendall(to_line(wanted))
        if stood_still:
            time.sleep(0.6)  # noqa: ASYNC251 - the daemon stands still
        await rig.until(lambda: bool(rig.unit.machine.refusals or rig.states))
    turning.cancel()
    await server.stop()
    if stood_still:
        assert rig.states == []
        assert rig.unit.machine.refusals[-1].request == "command 1"
    else:
        await rig.to(State.IDLE)
