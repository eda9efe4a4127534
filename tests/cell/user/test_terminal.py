"""A cell without a line PLC is commissioned from the terminal; beside one, Abort still works."""

import json
import os
import signal
import subprocess
from typing import Any

import pytest

from cellctl.records.store import RunStore
from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import OwnCell, cellctl
from tests.unit.command.test_arbiter import audit

pytestmark = pytest.mark.timeout(300)


class Terminal:
    """An operator at the cell's PC."""

    def __init__(self, own: OwnCell) -> None:
        self._socket = own.data / "cellctl.sock"

    def __call__(self, *words: str) -> subprocess.CompletedProcess[str]:
        return cellctl(*words, "--socket", str(self._socket))

    def does(self, *words: str) -> str:
        done = self(*words)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    def status(self) -> dict[str, Any]:
        report: dict[str, Any] = json.loads(self.does("status", "--json"))
        return report


@pytest.mark.long
def test_a_procedure_without_a_line(visited: OwnCell) -> None:
    visited.daemon().ready()
    terminal = Terminal(visited)
    assert terminal.does("abort") == "aborted, mode production"
    refused = terminal("reset")
    assert refused.returncode == 1
    assert "F715" in refused.stderr
    assert "0x84" in refused.stderr
    assert terminal.does("clear") == "stopped, mode production"
    assert "0x84" in terminal("procedure", "104").stderr, "not in Stopped, whatever the mode"
    assert terminal.does("mode", "maintenance") == "stopped, mode maintenance"
    assert terminal.does("reset") == "idle, mode maintenance"
    assert terminal.status()["ready"]
    refused = terminal("start", "--serial", "S.1")
    assert refused.returncode == 1
    assert "0x10E" in refused.stderr
    assert "`cellctl mode production` first" in refused.stderr
    assert terminal.status()["state"] == "IDLE"
    with visited.control() as control:
        control.request("present", frame=False, deck=False)
        control.request("place_target_board", head="head_1")
        assert terminal.does("procedure", "104", "--wait") == "completed, mode maintenance"
        control.request("remove_boards")
    assert "Completed" in terminal.does("status")
    assert terminal.does("alarms") == "no alarms"
    store = RunStore(visited.data, create=False)
    entries = [(who.split(":")[0], action) for who, action, _ in audit(store)]
    store.close()
    actions = ("abort", "clear", "set", "reset", "start", "procedure ended")
    assert entries == [("terminal", action) for action in actions]


def test_beside_a_line_that_is_in_control(visited: OwnCell) -> None:
    visited.daemon().ready()
    terminal = Terminal(visited)
    with OutsidePlc(visited.modbus_port) as plc:
        plc.start_heartbeat()
        assert plc.command("Reset") == 0
        plc.done()
        for words in (["start", "--serial", "S.1"], ["mode", "maintenance"], ["procedure", "107"]):
            refused = terminal(*words)
            assert refused.returncode == 1
            assert "0x10B" in refused.stderr
        assert plc.command("Start", mode=1, recipe=1, serial="LINE.1") == 0
        plc.until("first step", lambda: plc.value("step") == 10)
        assert terminal.status()["control"] == "line"
        assert terminal.does("abort") == "aborted, mode production"
        assert plc.done() == "ended in Aborted"
        assert plc.state == "Aborted"
        assert terminal.does("clear") == "stopped, mode production"
        assert "0x10B" in terminal("reset").stderr
        assert plc.command("Reset") == 0
        plc.done(60)


@pytest.mark.long
def test_a_killed_daemons_socket_is_replaced(visited: OwnCell) -> None:
    first = visited.daemon()
    first.ready()
    os.kill(first.process.pid, signal.SIGKILL)
    first.end()
    first.nobody_left(10)
    terminal = Terminal(visited)
    assert "F714" in terminal("status").stderr
    second = visited.daemon()
    second.ready()
    assert terminal.status()["connected"]
    assert second.interrupt(signal.SIGTERM) == 0
    assert not (visited.data / "cellctl.sock").exists()
