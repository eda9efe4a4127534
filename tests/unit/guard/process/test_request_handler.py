"""What the guard does with a request, without a process around it."""

import pytest

from cellctl.guard.messages import Message
from cellctl.guard.process.request_handler import RequestHandler
from cellctl.guard.process.stop_supervisor import StopSupervisor
from tests.unit.guard.process.samples import HEALTHY, ready_monitor
from tests.unit.guard.process.test_stop_supervisor import Channel


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
