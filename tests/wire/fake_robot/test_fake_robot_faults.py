"""Faults of the fake controller that need no socket: panel, rejects, aborts, lost answers."""

import pytest

from fakes.faults import ROBOT_FAULTS, FaultBoard
from tests.wire.fake_robot.fake_robot_bench import Bench, at_work, words


@pytest.fixture
def bench() -> Bench:
    return at_work()


@pytest.mark.parametrize(
    ("fault", "reason", "panel"),
    [
        ("emergency_stop", "ESTOP", "ESTOP"),
        ("manual_mode", "MODE", "MODE"),
        ("drives_off", "DRIVES", "DRIVES"),
        ("vendor_error", "ERROR", "ERROR"),
    ],
)
def test_panel_aborts_a_motion_and_keeps_out_the_next(
    bench: Bench, fault: str, reason: str, panel: str
) -> None:
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.faults.inject(fault)
    assert words(bench.run(1.0))[0] == ("CMD", "ABRT", "2", reason)
    assert bench.send("MOVL", f"{bench.pose(-1)},20,200") == [["REJ", "3", panel]]
    bench.faults.clear()
    assert bench.send("MOVL", f"{bench.pose(-1)},20,200") == [["REJ", "4", "LATCHED"]]
    assert bench.send("REARM")[0] == ["ACK", "5"]


def test_emergency_stop_mid_move(bench: Bench) -> None:
    bench.faults.inject("emergency_stop_mid_move", after_s=0.3)
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    assert words(bench.run(1.0))[0] == ("CMD", "ABRT", "2", "ESTOP")
    assert bench.controller.panel.emergency_stop
    assert bench.send("REARM") == [["REJ", "3", "ESTOP"]]


def test_injected_rejects_and_aborts_act_as_often_as_told(bench: Bench) -> None:
    bench.faults.inject("reject", count=1, reason="LOAD")
    assert bench.send("MOVL", f"{bench.pose(-1)},20,200") == [["REJ", "2", "LOAD"]]
    bench.faults.inject("abort", count=1, reason="ERROR", after_s=0.1)
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    assert words(bench.run(1.0))[0] == ("CMD", "ABRT", "3", "ERROR")


def test_stop_request_overheard_once(bench: Bench) -> None:
    bench.faults.inject("ignore_stop", count=1)
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.abort(number=1)
    assert bench.run(0.5) == []
    bench.abort(number=1)
    assert words(bench.run(0.5))[0] == ("CMD", "ABRT", "2", "STOP")


def test_slow_stop(bench: Bench) -> None:
    bench.faults.inject("stop_latency", latency_s=0.5)
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.abort()
    assert bench.run(0.48) == []
    assert len(bench.run(0.2)) == 2


def test_swallowed_command_moves_nothing(bench: Bench) -> None:
    bench.faults.inject("never_ack", count=1)
    before = bench.pose(0)
    assert bench.send("MOVL", f"{bench.pose(-10)},50,200") == []
    bench.run(1.0)
    assert bench.pose(0) == before


def test_unreported_end(bench: Bench) -> None:
    bench.faults.inject("never_done", count=1)
    assert bench.send("MOVL", f"{bench.pose(-1)},50,200") == [["ACK", "2"]]
    assert bench.run(2.0) == []
    assert bench.send("MOVL", f"{bench.pose(-1)},50,200") == [["ACK", "3"]]


def test_no_motion_at_override_zero(bench: Bench) -> None:
    bench.faults.inject("override_zero")
    assert bench.send("MOVL", f"{bench.pose(-1)},50,200") == [["REJ", "2", "SPEED"]]


def test_unknown_fault_names_are_refused() -> None:
    with pytest.raises(ValueError, match="knows no fault"):
        FaultBoard("main", ROBOT_FAULTS).inject("gremlins")
