"""Ctrl-C and SIGTERM at any moment: motion stops, the run is closed as aborted, nobody is left."""

import os
import signal
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from cellctl.calibration.store.envelope import read_stored, write_stored
from cellctl.records.entries import RunHead
from cellctl.records.store import RunStore
from fakes.demo.control import Control
from tests.rigs.whole_cell.own_cell import OwnCell, Program
from tests.rigs.wire.ports import free_port

pytestmark = pytest.mark.timeout(300)

STANDSTILL_S = 0.5
"""More than the stop latency and the ramp of every robot of the scenario."""


def send(program: Program, number: signal.Signals) -> None:
    """SIGTERM as a service manager does, SIGINT and SIGHUP as a terminal: to the whole group."""
    if number is signal.SIGTERM:
        program.process.send_signal(number)
    else:
        os.killpg(program.process.pid, number)


def ends_in_order(daemon: Program) -> None:
    assert daemon.end() == 0
    daemon.nobody_left()
    assert "Traceback" not in daemon.stderr
    daemon.logged("ended", timeout_s=0.1)


def stands(own: OwnCell) -> dict[str, Any]:
    """The truth, after making sure that nothing moves any more."""
    time.sleep(STANDSTILL_S)  # of the world, not a handshake: nobody but the world knows
    with own.control() as control:
        first = control.request("truth")["truth"]
        time.sleep(STANDSTILL_S)
        second = control.request("truth")["truth"]
    for pose in ("base_T_flange_mm_deg", "base_T_c1_mm_deg", "base_T_c2_mm_deg"):
        assert second[pose] == pytest.approx(first[pose], abs=2e-4), f"{pose} moves"
    return dict(second)


def heads(store: Path) -> list[RunHead]:
    opened = RunStore(store, create=False)
    try:
        return opened.runs()
    finally:
        opened.close()


def calibrated_ten_degrees_aside(folder: Path) -> None:
    """Calibrate as if the heads had been taught there before the board transfer was made."""
    stored = read_stored(folder, "board_transfer")
    joints_deg = {
        head: [joints[0] - 10.0, *joints[1:]]
        for head, joints in stored.record["head_joints_deg"].items()
    }
    record = {**stored.record, "head_joints_deg": joints_deg}
    write_stored(folder, replace(stored, record=record))


def only_run_is_aborted(own: OwnCell) -> None:
    (head,) = heads(own.data)
    assert head.result == "aborted"
    assert head.ended is not None


def camera(control: Control) -> list[float]:
    """The true pose of head I."""
    return list(control.request("truth")["truth"]["base_T_c1_mm_deg"])


def without_precision(own: OwnCell) -> None:
    """Make the loop so coarse that the deck is soon where it is mated."""
    own.change("threshold_mm = 0.05", "threshold_mm = 0.15\nframes = 1")
    own.change("threshold_deg = 0.006", "threshold_deg = 0.05")


def test_while_connecting(own: OwnCell) -> None:
    daemon = own.daemon()
    daemon.until("listening for robots", lambda: _listens(own.ports[7001]))
    send(daemon, signal.SIGTERM)
    assert daemon.end(10) == 0
    daemon.nobody_left()
    assert "Traceback" not in daemon.stderr


def test_idle_and_hung_up(visited: OwnCell) -> None:
    daemon = visited.daemon()
    daemon.ready()
    send(daemon, signal.SIGHUP)
    ends_in_order(daemon)


@pytest.mark.figures  # beside Ctrl-C while it connects and at rest
def test_while_heads_move(visited: OwnCell) -> None:
    slow = "speed_percent = 5\nlinear_speed_mm_s = 250.0"
    visited.change("linear_speed_mm_s = 250.0", slow)  # of both robots that carry a head
    visited.change("measuring = [-", "measuring = [-1")  # ten degrees from where it is
    calibrated_ten_degrees_aside(visited.calibration)
    daemon = visited.daemon()
    daemon.ready()
    plc = visited.plc()
    with visited.control() as control:
        before = camera(control)
        daemon.until("motion", lambda: camera(control) != pytest.approx(before, abs=0.05))
    send(daemon, signal.SIGTERM)
    ends_in_order(daemon)
    stands(visited)
    only_run_is_aborted(visited)
    assert plc.end() != 0


@pytest.mark.long
def test_while_measuring(visited: OwnCell) -> None:
    daemon = visited.daemon()
    daemon.ready()
    visited.plc()
    daemon.logged("step begins", step="measure frame")
    send(daemon, signal.SIGINT)
    ends_in_order(daemon)
    stands(visited)
    only_run_is_aborted(visited)


@pytest.mark.long
def test_while_mating(visited: OwnCell) -> None:
    without_precision(visited)
    daemon = visited.daemon()
    daemon.ready()
    visited.plc()
    daemon.logged("step begins", step="mate", timeout_s=120)
    with visited.control() as control:
        daemon.until(
            "way down",
            lambda: control.request("truth")["truth"]["frame_T_deck_mm_deg"][2] < 23.0,
        )
    send(daemon, signal.SIGINT)
    ends_in_order(daemon)
    truth = stands(visited)
    only_run_is_aborted(visited)
    assert truth["peak_contact_force_n"] < 50.0


@pytest.mark.parametrize("moment", ["starting", pytest.param("measuring", marks=pytest.mark.long)])
def test_demonstration(own: OwnCell, moment: str) -> None:
    out = own.folder / "run"
    demo = own.demo(out)
    wanted = {"starting": "starting fake cell", "measuring": "measure frame"}[moment]
    demo.until(wanted, lambda: wanted in demo.stdout)
    send(demo, signal.SIGTERM if moment == "starting" else signal.SIGINT)
    assert demo.end(40) == 130
    demo.nobody_left()
    assert demo.stderr == ""
    assert "stopped: " in demo.stdout
    if moment == "measuring":
        assert "run 1 is closed as aborted" in demo.stdout
        (head,) = heads(out / "store")
        assert head.result == "aborted"


@pytest.mark.long  # the line drives such a cell in other tests, and Ctrl-C ends one above
def test_cell_that_stays_up(own: OwnCell) -> None:
    """`make cell`: both stay until Ctrl-C, which is not a failure."""
    demo = own.demo(own.folder / "run", "--stay")
    demo.until("an address for the PLC", lambda: "Ctrl-C ends both" in demo.stdout)
    assert f"127.0.0.1:{own.modbus_port}" in demo.stdout
    assert "python -m fakes operator status --port" in demo.stdout
    send(demo, signal.SIGINT)
    assert demo.end(40) == 0
    demo.nobody_left()


def _listens(port: int) -> bool:
    """Somebody has the port; does not connect to it."""
    return any(line.split()[1].endswith(f":{port:04X}") for line in _tcp() if " 0A " in line)


def _tcp() -> list[str]:
    return Path("/proc/net/tcp").read_text(encoding="ascii").splitlines()[1:]


def test_port_of_the_test_is_free() -> None:
    assert not _listens(free_port())
