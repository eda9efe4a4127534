"""Streamed motion of the fake controller, by simulated time and without a socket
(docs/protocols/sjl-1.md, section 7).
"""

import numpy as np
import pytest

from fakes.wire.sjl.records import RecordError
from fakes.wire.sjl.stream import StreamOffer
from fakes.world.frames import distance, from_written
from tests.wire.fake_robot.fake_robot_bench import Bench, at_work

ASKED = "0.1,0.05,30,5,200"
PERIOD_S = 0.008


class StreamBench:
    """A bench in the middle of a stream, at the height where it began."""

    def __init__(self, asked: str = ASKED) -> None:
        self.bench = at_work()
        self.controller = self.bench.controller
        self.controller.offer = StreamOffer()
        self.start = self.controller.arm.encoder_pose(self.bench.time_s)
        assert self.bench.send("STREAM", asked) == [["ACK", "2"]]
        self.ended: list[list[str]] = []
        self.tick = 0

    def set(self, dz_mm: float, number: int | None = None, session: int = 11) -> None:
        """A setpoint above the start, for the next tick unless another is named."""
        x, y, z = self.start.translation * 1000
        pose = f"{x:.4f},{y:.4f},{z + dz_mm:.4f},90,0,180"
        fields = ["SET", str(session), str(number or self.tick + 1), *pose.split(",")]
        assert self.controller.command(fields, self.bench.time_s) == []

    def run(self, ticks: int = 1) -> list[list[str]]:
        """Run so many ticks; what else the controller says is kept in ``ended``."""
        records: list[list[str]] = []
        for _ in range(2000):
            if len(records) == ticks or self.ended:
                break
            for channel, record in self.bench.run(0.004):
                kept = records if record[0] == "TICK" else self.ended
                kept.append(record if channel == "CMD" else [channel, *record])
        if records:
            self.tick = int(records[-1][1])
        return records

    def height_mm(self) -> float:
        here = self.controller.arm.encoder_pose(self.bench.time_s)
        return float(here.translation[2] - self.start.translation[2]) * 1000

    def end(self) -> list[str]:
        """How the stream ended: ABRT or DONE without its pose."""
        self.run(1000)
        assert self.ended
        return self.ended[0][:3] if self.ended[0][0] == "ABRT" else self.ended[0][:2]


@pytest.fixture
def stream() -> StreamBench:
    return StreamBench()


def test_ticks_come_at_their_period_from_the_beginning(stream: StreamBench) -> None:
    ticks = stream.run(5)
    assert [tick[1] for tick in ticks] == ["1", "2", "3", "4", "5"]
    times = np.diff([int(tick[2]) for tick in ticks])
    assert set(times) == {8}
    assert [tick[3:6] for tick in ticks[:3]] == [["0", "0", "0"], ["0", "0", "1"], ["0", "0", "2"]]
    reached = from_written([float(text) for text in ticks[-1][6:]])
    assert distance(stream.start, reached)[0] < 2e-7


def test_the_arm_follows_at_most_a_step_a_tick(stream: StreamBench) -> None:
    heights = []
    stream.run()
    for number in range(1, 21):
        stream.set(0.1 * number)
        stream.run()
        heights.append(stream.height_mm())
    steps = np.diff(heights)
    assert steps.max() < 0.1 + 1e-3
    stream.set(2.0)
    stream.run(2)
    assert stream.height_mm() == pytest.approx(2.0, abs=1e-4)


def test_a_lost_setpoint_is_counted_and_its_way_is_never_run_faster(stream: StreamBench) -> None:
    stream.run()
    stream.set(0.1)
    stream.run(3)  # two ticks without a setpoint
    stream.set(0.3)  # three steps after three ticks: allowed, and covered one step a tick
    before = stream.height_mm()
    (tick,) = stream.run()
    assert tick[5] == "2"
    stream.run()
    assert stream.height_mm() - before <= 0.2 + 1e-3
    stream.run(2)
    assert stream.height_mm() == pytest.approx(0.3, abs=1e-4)


def test_late_and_repeated_setpoints_are_counted(stream: StreamBench) -> None:
    stream.run(3)
    stream.set(0.1, number=2)  # its tick has passed
    (tick,) = stream.run()
    assert tick[3:5] == ["2", "1"]
    stream.set(0.1, number=2)
    (tick,) = stream.run()
    assert tick[3:5] == ["2", "2"]
    stream.set(0.15)
    (tick,) = stream.run()
    assert tick[3:5] == ["6", "2"]


def test_a_setpoint_for_a_later_tick_is_a_violation(stream: StreamBench) -> None:
    stream.run(2)
    with pytest.raises(RecordError):
        stream.set(0.1, number=4)


@pytest.mark.parametrize(("dz_mm", "number"), [(0.11, 2), (-0.11, 2), (0.32, 4), (40.0, 4)])
def test_a_setpoint_too_far_away_ends_the_stream(dz_mm: float, number: int) -> None:
    stream = StreamBench()
    stream.run(number - 1)
    stream.set(dz_mm, number)
    assert stream.end() == ["ABRT", "2", "STEP"]
    assert abs(stream.height_mm()) < 1e-4
    assert stream.controller.latched


def test_a_setpoint_that_turns_too_far_ends_the_stream(stream: StreamBench) -> None:
    stream.run()
    x, y, z = stream.start.translation * 1000
    fields = f"SET,11,2,{x:.4f},{y:.4f},{z:.4f},90.06,0,180".split(",")
    stream.controller.command(fields, stream.bench.time_s)
    assert stream.end() == ["ABRT", "2", "STEP"]


def test_travel_is_limited() -> None:
    stream = StreamBench("0.1,0.05,0.25,5,200")
    stream.run()
    for dz_mm in (0.1, 0.2):
        stream.set(dz_mm)
        stream.run()
    stream.set(0.3)
    assert stream.end() == ["ABRT", "2", "TRAVEL"]
    assert stream.height_mm() == pytest.approx(0.2, abs=1e-3)


def test_out_of_reach_ends_the_stream() -> None:
    stream = StreamBench()
    far = from_written([5000, 0, 900, 90, 0, 180]).as_matrix()
    motion = stream.controller._motion
    assert motion is not None
    assert motion.stream is not None
    motion.stream._command = motion.stream._setpoint = far
    assert stream.end() == ["ABRT", "2", "REACH"]


def test_without_setpoints_the_stream_ends_in_its_time(stream: StreamBench) -> None:
    stream.run()
    stream.set(0.1)
    stream.run()
    before_s = stream.bench.time_s
    assert stream.end() == ["ABRT", "2", "STALE"]
    assert stream.bench.time_s - before_s == pytest.approx(0.2 + PERIOD_S, abs=2 * PERIOD_S)
    assert stream.height_mm() == pytest.approx(0.1, abs=1e-4)
    assert stream.bench.send("STREAM", ASKED) == [["REJ", "3", "LATCHED"]]
    assert stream.bench.send("REARM")[0] == ["ACK", "4"]


def test_finish_ends_without_a_latch(stream: StreamBench) -> None:
    stream.run()
    stream.set(0.1)
    stream.run(2)
    stream.controller.command(["FINISH", "11", "3"], stream.bench.time_s)  # another's number
    stream.set(0.1)
    assert stream.run()
    stream.controller.command(["FINISH", "11", "2"], stream.bench.time_s)
    assert stream.end() == ["DONE", "2"]
    assert not stream.controller.latched
    assert stream.height_mm() == pytest.approx(0.1, abs=1e-4)
    assert stream.bench.send("STREAM", ASKED) == [["ACK", "3"]]


@pytest.mark.parametrize("channel", ["STA", "GRD"])
def test_a_stop_ends_the_stream_after_the_dead_time_of_the_controller(channel: str) -> None:
    stream = StreamBench()
    stream.controller.opened("GRD", 13, stream.bench.time_s)
    stream.bench.beating.add("GRD")
    stream.run()
    for number in range(1, 31):
        stream.set(0.1 * number)
        stream.run()
    before_mm, before_s = stream.height_mm(), stream.bench.time_s
    stream.bench.abort(channel)  # type: ignore[arg-type]
    braking = stream.run(12)
    assert len(braking) == 12  # the ticks go on until the arm stands
    stream.bench.abort(channel)  # type: ignore[arg-type]  # a repeated request puts nothing off
    assert stream.end() == ["ABRT", "2", "STOP"]
    settings = stream.controller.arm.settings
    speed_mm_s = 0.1 / PERIOD_S
    over_mm = speed_mm_s * settings.stop_latency_ms / 1000
    assert stream.height_mm() - before_mm == pytest.approx(over_mm, rel=0.1)
    standing_s = settings.stop_latency_ms / 1000 + speed_mm_s / settings.stop_deceleration_mm_s2
    assert stream.bench.time_s - before_s == pytest.approx(standing_s, abs=0.01)
    assert [channel, "STOPD", "1"] in [record[:3] for record in stream.ended]
    assert stream.controller.latched


def test_a_missed_heartbeat_ends_the_stream(stream: StreamBench) -> None:
    stream.run()
    stream.bench.beating.clear()
    for _ in range(100):
        stream.set(0.0)
        stream.run()
        if stream.ended:
            break
    assert stream.ended[0][:3] == ["ABRT", "2", "DEADMAN"]


def test_emergency_stop_ends_the_stream(stream: StreamBench) -> None:
    stream.run()
    stream.bench.faults.inject("emergency_stop")
    assert stream.end() == ["ABRT", "2", "ESTOP"]


@pytest.mark.parametrize(
    "asked",
    ["0.11,0.05,30,5,200", "0.1,0.06,30,5,200", "0.1,0.05,31,5,200", "0.1,0.05,30,6,200",
     "0.1,0.05,30,5,201", "0,0.05,30,5,200", "0.1,0.05,30,5,0"],
)  # fmt: skip
def test_more_than_is_offered_is_rejected(asked: str) -> None:
    bench = at_work()
    bench.controller.offer = StreamOffer()
    assert bench.send("STREAM", asked) == [["REJ", "2", "STREAM"]]
    assert bench.send("STREAM", ASKED) == [["ACK", "3"]]
    assert bench.send("MOVL", f"{bench.pose(-5)},50,200") == [["REJ", "4", "BUSY"]]


def test_a_job_program_without_the_option_rejects() -> None:
    assert at_work().send("STREAM", ASKED) == [["REJ", "2", "STREAM"]]


def test_setpoints_without_a_stream_are_passed_over() -> None:
    bench = at_work()
    for word, values in (("SET", "1,2,3,4,5,6"), ("FINISH", "")):
        fields = [word, "11", "2", *(values.split(",") if values else [])]
        assert bench.controller.command(fields, bench.time_s) == []
    stream = StreamBench()
    stream.run()
    stream.set(0.1, session=12)
    (tick,) = stream.run()
    assert tick[3:6] == ["0", "0", "1"]


@pytest.mark.parametrize("fields", [["SET", "11", "2"], ["STREAM", "11", "2"], ["FINISH", "11"]])
def test_records_of_the_wrong_length_are_violations(fields: list[str]) -> None:
    with pytest.raises(RecordError):
        Bench().controller.command(fields, 0.0)


def test_the_option_of_the_hello() -> None:
    assert StreamOffer().option() == "STREAM=8/0.1000/0.0500/30.0000/5.0000/200"
