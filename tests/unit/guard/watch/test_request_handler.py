"""What the guard does with a request, without a process around it."""

import pytest

from cellctl.guard.limits import GuardLimits
from cellctl.guard.messages import Message
from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.guard.watch.request_handler import TARE_GRACE_S, RequestHandler
from cellctl.guard.watch.stop_supervisor import StopSupervisor
from tests.unit.guard.watch.samples import HEALTHY, ready_monitor, sample
from tests.unit.guard.watch.test_stop_supervisor import Channel, opened


def compensation(weight_n: float) -> Message:
    load = [[0.0, 0.0, weight_n]] + [[0.0, 0.0, 0.0]] * 5
    request = {"load": load, "offset": [0.0] * 6, "base_down": [0.0, 0.0, -1.0]}
    return {"id": 3, "do": "gravity_compensation", **request}


@pytest.mark.parametrize(
    ("weight_n", "channel", "taken"),
    [(0.0, None, True), (100.0, Channel(), True), (100.0, None, False)],
)
def test_only_a_load_that_hangs_needs_the_flange_pose(
    weight_n: float, channel: Channel | None, *, taken: bool
) -> None:
    supervisor = StopSupervisor(channel, confirm_s=0.1)
    handler = RequestHandler(ready_monitor(), supervisor, lambda: HEALTHY)
    answer = handler.answer(compensation(weight_n), 0.0)
    assert answer is not None
    assert ("refused" not in answer) == taken


def test_a_stop_goes_out_at_once_armed_or_not_and_is_wanted_until_acknowledged() -> None:
    channel = Channel()
    supervisor, monitor = opened(channel), ready_monitor()
    handler = RequestHandler(monitor, supervisor, lambda: HEALTHY)
    assert handler.answer({"id": 1, "do": "stop"}, 0.0) == {"id": 1, "result": None}
    assert channel.stops == 1
    supervisor.beat(0.05)
    assert (channel.stops, channel.beats) == (2, 1)
    supervisor.beat(0.2)
    assert (channel.stops, channel.beats) == (3, 1), "a stop that is not confirmed ends the beats"
    handler.answer({"id": 2, "do": "acknowledge"}, 0.3)
    supervisor.beat(0.3)
    assert (channel.stops, channel.beats) == (3, 2)


def test_a_stop_leaves_the_limits_watched() -> None:
    monitor = ready_monitor()
    handler = RequestHandler(monitor, opened(Channel()), lambda: HEALTHY)
    monitor.channel_up = True
    monitor.arm(GuardLimits(raw=(20.0,) * 6), HEALTHY, monitor.sample_time_s)
    handler.answer({"id": 1, "do": "stop"}, 0.0)
    assert monitor.armed
    monitor.sample(sample(0.001, 25.0))
    assert monitor.trip is not None


def test_a_stop_lets_the_load_swing_where_the_limits_say_so() -> None:
    monitor = ready_monitor()
    handler = RequestHandler(monitor, opened(Channel()), lambda: HEALTHY)
    monitor.channel_up = True
    limits = GuardLimits(raw=(20.0,) * 6, braking=(40.0,) * 6)
    monitor.arm(limits, HEALTHY, monitor.sample_time_s)
    handler.answer({"id": 1, "do": "stop"}, 0.0)
    monitor.sample(sample(0.001, 25.0))
    assert monitor.trip is None


def handler_of(monitor: WrenchMonitor, channel: Channel | None = None) -> RequestHandler:
    return RequestHandler(monitor, StopSupervisor(channel, confirm_s=0.1), lambda: HEALTHY)


@pytest.mark.parametrize(
    "request_",
    [
        {"id": 1, "do": "dance"},
        {"id": 1, "do": "tare"},
        {"id": 1, "do": "tare", "duration_s": "long"},
        {"id": 1, "do": "arm", "limits": {"raw": "high"}},
        {"id": 1, "do": "wrench_frame", "rotation": None, "translation_m": [0.0] * 3},
        compensation(1.0) | {"id": 1, "load": [[0.0, 0.0, 1.0]] * 5},
        compensation(1.0) | {"id": 1, "offset": [0.0] * 5},
        compensation(1.0) | {"id": 1, "base_down": [0.0, 1.0]},
    ],
)
def test_what_makes_no_sense_is_refused_and_the_guard_goes_on(request_: Message) -> None:
    monitor = ready_monitor()
    handler = handler_of(monitor, Channel())
    answer = handler.answer(request_, 0.0)
    assert answer is not None
    assert answer["id"] == 1
    assert "not understood" in answer["refused"]
    assert not monitor.armed
    assert not handler.quit


def test_the_load_and_the_frame_stay_while_the_limits_are_watched() -> None:
    monitor = ready_monitor()
    handler = handler_of(monitor)
    monitor.arm(GuardLimits(raw=(20.0,) * 6), HEALTHY, monitor.sample_time_s)
    rotation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    frame = {"id": 4, "do": "wrench_frame", "rotation": rotation, "translation_m": [0.0] * 3}
    for request in compensation(0.0), frame:
        answer = handler.answer(request, 0.0)
        assert answer is not None
        assert "refused" in answer
    handler.answer({"id": 5, "do": "disarm"}, 0.0)
    assert not monitor.armed
    assert handler.answer(frame, 0.0) == {"id": 4, "result": None}


def test_a_tare_is_answered_when_its_samples_are_in() -> None:
    monitor = ready_monitor()
    handler = handler_of(monitor)
    assert handler.answer({"id": 7, "do": "tare", "duration_s": 0.05}, 0.0) is None
    assert handler.late_answer(0.0) is None
    for step in range(1, 101):
        monitor.sample(sample(step / 1000, fz=3.0))
    answer = handler.late_answer(0.1)
    assert answer is not None
    assert answer["id"] == 7
    assert answer["result"]["mean"][2] == pytest.approx(3.0)
    assert answer["result"]["samples"] >= 40
    assert handler.late_answer(0.2) is None, "it is answered once"


def test_a_tare_without_samples_is_given_up_and_another_can_begin() -> None:
    handler = handler_of(ready_monitor())
    handler.answer({"id": 8, "do": "tare", "duration_s": 0.05}, 0.0)
    assert handler.late_answer(0.05 + TARE_GRACE_S) is None
    answer = handler.late_answer(0.06 + TARE_GRACE_S)
    assert answer is not None
    assert "no samples" in answer["refused"]
    assert handler.answer({"id": 9, "do": "tare", "duration_s": 0.05}, 1.0) is None


def test_the_end_is_asked_for_and_not_taken() -> None:
    handler = handler_of(ready_monitor())
    assert handler.answer({"id": 2, "do": "quit"}, 0.0) == {"id": 2, "result": None}
    assert handler.quit
