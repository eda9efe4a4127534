"""The daemon is killed in the middle of a run: nothing resumes, and the record says so."""

import os
import signal
import time

import pytest

from cellctl.records.store import RunStore
from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import OwnCell, cellctl

pytestmark = pytest.mark.timeout(180)

QUIET_S = 3.0
"""Long enough for a robot that would move by itself."""


def poses(own: OwnCell) -> list[float]:
    with own.control() as control:
        truth = control.request("truth")["truth"]
    names = ("base_T_flange_mm_deg", "base_T_c1_mm_deg", "base_T_c2_mm_deg")
    return [value for name in names for value in truth[name]]


def test_killed_in_a_run_and_started_again(visited: OwnCell) -> None:
    first = visited.daemon()
    first.ready()
    with OutsidePlc(visited.modbus_port) as plc:
        plc.start_heartbeat()
        assert plc.command("Reset") == 0
        plc.done()
        assert plc.command("Start", mode=1, recipe=1, serial="KILLED.1") == 0
        first.logged("step begins", step="measure frame")
        started = plc.seq
    os.kill(first.process.pid, signal.SIGKILL)
    first.end()
    first.nobody_left(10)  # guard and workers notice

    second = visited.daemon()
    second.ready()
    second.logged("an earlier process left runs open", timeout_s=1)
    before = poses(visited)
    with OutsidePlc(visited.modbus_port) as plc:
        plc.start_heartbeat()
        assert plc.state in ("Stopped", "Aborted")
        plc.seq = started - 1  # what the PLC still has in its registers
        assert plc.command("Start", mode=1, recipe=1, serial="KILLED.1") == 0x100
        assert plc.done().startswith("stood in the registers when the cell started")
        time.sleep(QUIET_S)
        assert plc.state in ("Stopped", "Aborted")
        assert poses(visited) == pytest.approx(before, abs=2e-4)
        assert plc.command("Reset") == 0
        plc.done(60)
        assert plc.state == "Idle"
    _record_says_interrupted(visited)


@pytest.mark.long
def test_first_number_again_after_a_restart(visited: OwnCell) -> None:
    """1 says that the PLC begins anew, unless it is the very number of before."""
    for code in (0, 0x100):
        daemon = visited.daemon()
        daemon.ready()
        with OutsidePlc(visited.modbus_port) as plc:
            plc.start_heartbeat()
            assert plc.command("Reset") == code
            plc.done()
        assert daemon.interrupt(signal.SIGTERM) == 0


def _record_says_interrupted(own: OwnCell) -> None:
    store = RunStore(own.data, create=False)
    try:
        (head,) = store.runs()
        assert store.verify() == []
    finally:
        store.close()
    assert head.result == "interrupted"
    assert head.ended is not None
    assert "interrupted" in cellctl("runs", "list", "--data-dir", str(own.data)).stdout
