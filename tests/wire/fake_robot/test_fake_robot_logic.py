"""Decisions of the fake controller, by simulated time and without a socket."""

import numpy as np
import pytest

from fakes.wire.sjl.records import RecordError
from tests.wire.fake_robot.fake_robot_bench import HOME, Bench, at_work, words


@pytest.fixture
def bench() -> Bench:
    return at_work()


def test_linear_motion_ends_at_its_target(bench: Bench) -> None:
    target = bench.pose(-20)
    assert bench.send("MOVL", f"{target},50,200") == [["ACK", "2"]]
    ((channel, record),) = bench.run(2.0)
    assert channel == "CMD"
    assert record[:2] == ["DONE", "2"]
    reached = np.array([float(text) for text in record[2:]])
    np.testing.assert_allclose(reached[:3], [float(t) for t in target.split(",")[:3]], atol=2e-4)


def test_sequence_numbers(bench: Bench) -> None:
    assert bench.send("REARM", seq=1) == [["DUP", "1"]]
    assert bench.send("REARM", seq=3) == [["REJ", "3", "SEQ"]]
    assert bench.send("REARM", seq=2, session=99) == [["REJ", "2", "SESSION"]]
    assert bench.send("REARM", seq=2)[0] == ["ACK", "2"]


def test_second_motion_while_one_runs_is_busy(bench: Bench) -> None:
    bench.send("MOVL", f"{bench.pose(-20)},50,200")
    assert bench.send("MOVL", f"{bench.pose(-20)},50,200") == [["REJ", "3", "BUSY"]]
    assert words(bench.run(3.0))[0][:3] == ("CMD", "DONE", "2")


def test_rearm_is_answered_by_ack_and_done(bench: Bench) -> None:
    ack, done = bench.send("REARM")
    assert ack == ["ACK", "2"]
    assert done[:2] == ["DONE", "2"]
    assert len(done) == 8


def test_step_limit_of_distance_and_angle(bench: Bench) -> None:
    assert bench.send("STEP", f"{bench.pose(-0.6)},5") == [["REJ", "2", "STEP"]]
    tilted = bench.pose(-0.1).replace("90,0,180", "90.6,0,180")
    assert bench.send("STEP", f"{tilted},5") == [["REJ", "3", "STEP"]]
    assert bench.send("STEP", f"{bench.pose(-0.4)},5") == [["ACK", "4"]]


def test_bad_values_are_rejected_by_their_reason(bench: Bench) -> None:
    assert bench.send("MOVL", f"{bench.pose(-5)},0,200")[0][2] == "SPEED"
    assert bench.send("MOVL", "5000,0,900,90,0,180,50,200")[0][2] == "REACH"
    assert bench.send("MOVJ", "0,90,0,0,0,0,10")[0][2] == "LIMIT"
    assert bench.send("MOVJ", f"{HOME},101")[0][2] == "SPEED"


@pytest.mark.parametrize(
    "fields",
    [
        ["JUMP", "11", "2"],
        ["MOVJ", "11", "2"],
        ["REARM", "11", "2", "3"],
        ["MOVL", "11", "2", *["1e3", *"0000011"]],
        ["REARM", "11", "-2"],
        [""],
    ],
)
def test_unknown_or_misshapen_commands_break_the_protocol(bench: Bench, fields: list[str]) -> None:
    with pytest.raises(RecordError):
        bench.controller.command(fields, bench.time_s)


def test_abort_stops_latches_and_reports_after_standstill(bench: Bench) -> None:
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(1.0)
    start = bench.controller.arm.encoder_pose(bench.time_s).translation[2]
    bench.abort(number=7)
    assert bench.run(0.24) == [], "nothing before standstill"
    out = bench.run(0.2)
    assert words(out) == [("CMD", "ABRT", "2", "STOP"), ("STA", "STOPD", "7", out[1][1][2])]
    over_mm = 1000 * (start - bench.controller.arm.encoder_pose(bench.time_s).translation[2])
    assert over_mm == pytest.approx(20 * 0.25 + 20**2 / (2 * 500), abs=0.1)
    assert bench.send("MOVL", f"{bench.pose(-1)},20,200") == [["REJ", "3", "LATCHED"]]
    assert bench.send("REARM")[0] == ["ACK", "4"]
    assert bench.send("MOVL", f"{bench.pose(-1)},20,200") == [["ACK", "5"]]


def test_abort_at_rest_is_answered_and_latches(bench: Bench) -> None:
    bench.abort(number=3)
    assert words(bench.run(0.01))[0][:3] == ("STA", "STOPD", "3")
    assert bench.controller.latched


def test_same_abort_again_is_answered_again(bench: Bench) -> None:
    for _ in range(2):
        bench.abort(number=3)
        assert words(bench.run(0.01))[0][:3] == ("STA", "STOPD", "3")


def test_rearm_is_refused_while_the_abort_runs_down(bench: Bench) -> None:
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.abort()
    assert bench.send("REARM") == [["REJ", "3", "LATCHED"]]


def test_motion_that_ends_during_an_abort_is_done(bench: Bench) -> None:
    bench.send("MOVL", f"{bench.pose(-1)},20,200")
    bench.run(0.06)
    bench.abort()
    assert [record[1] for record in words(bench.run(0.5))] == ["DONE", "STOPD"]


def test_missed_heartbeat_stops_and_latches(bench: Bench) -> None:
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.beating.clear()
    out = bench.run(1.0)
    assert words(out)[0] == ("CMD", "ABRT", "2", "DEADMAN")
    assert bench.controller.latched


def test_guard_must_beat_only_once_it_has_connected(bench: Bench) -> None:
    bench.run(1.0)
    assert not bench.controller.latched
    bench.controller.opened("GRD", 13, bench.time_s)
    bench.run(0.25)
    assert not bench.controller.latched
    bench.run(0.2)
    assert bench.controller.latched


def test_beat_of_another_session_does_not_count(bench: Bench) -> None:
    bench.beating.clear()
    for _ in range(4):
        bench.run(0.1)
        bench.controller.supervise("STA", ["BEAT", "99", "1"], bench.time_s)
    assert bench.controller.latched


def test_lost_channel_stops_and_must_come_back_before_rearm(bench: Bench) -> None:
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.controller.closed("STA", bench.time_s)
    assert words(bench.run(1.0)) == [("CMD", "ABRT", "2", "LINK")]
    assert bench.send("REARM") == [["REJ", "3", "LATCHED"]]
    bench.controller.opened("STA", 21, bench.time_s)
    assert bench.send("REARM")[0] == ["ACK", "4"]


def test_guard_that_never_connected_is_not_missed(bench: Bench) -> None:
    bench.controller.closed("GRD", bench.time_s)
    assert bench.send("MOVL", f"{bench.pose(-1)},20,200") == [["ACK", "2"]]


def test_guard_stops_too(bench: Bench) -> None:
    bench.controller.opened("GRD", 13, bench.time_s)
    bench.beating.add("GRD")
    bench.send("MOVL", f"{bench.pose(-100)},20,200")
    bench.run(0.5)
    bench.abort("GRD", 1)
    assert words(bench.run(0.5))[1][:3] == ("GRD", "STOPD", "1")
