"""What the guard does with a request, without a process around it."""

import pytest

from cellctl.guard.limits import GuardLimits
from cellctl.guard.messages import Message
from cellctl.guard.watch.request_handler import RequestHandler
from cellctl.guard.watch.stop_supervisor import StopSupervisor
from tests.unit.guard.watch.samples import HEALTHY, ready_monitor
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
