"""A stream needs every zone that its setpoints may reach."""

from collections.abc import AsyncIterator

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.zones.arbiter import ZoneArbiter
from cellctl.cell.zones.zone import Share, Zone
from cellctl.cell.zones.zoned_robot import ZonedStreamingRobot
from cellctl.errors.robot import ZoneTaken
from cellctl.geometry.box import Box
from cellctl.interfaces import StreamLimits
from tests.contracts.inprocess.streaming_robot import InProcessStreamingRobot

LIMITS = StreamLimits(step_m=1e-4, step_rad=1e-3, travel_m=0.02, travel_rad=0.05, loss_s=0.2)
ZONE = Box(np.array([1.51, -1.0, 0.0]), np.array([3.0, 1.0, 2.0]))
"""Both robots come up 10 mm beside it."""


@pytest.fixture
async def pair() -> AsyncIterator[tuple[ZonedStreamingRobot, InProcessStreamingRobot]]:
    """A robot that asks, and another one that shares its zone."""
    asking, other = InProcessStreamingRobot("asking"), InProcessStreamingRobot("other")
    zone = Zone("middle", dict.fromkeys(("asking", "other"), Share(ZONE, ())), 1.0)
    arbiter = ZoneArbiter((zone,), {"asking": asking.state, "other": other.state})
    robot = ZonedStreamingRobot(asking, arbiter, None)
    async with robot, other:
        yield robot, other


async def test_a_stream_that_may_reach_a_taken_zone_does_not_begin(
    pair: tuple[ZonedStreamingRobot, InProcessStreamingRobot],
) -> None:
    robot, other = pair
    other.flange = RigidTransform.from_translation([2.0, 0.0, 1.0])
    with pytest.raises(ZoneTaken, match="other stands in it"):
        async with robot.stream(LIMITS):
            pytest.fail("it has begun")


async def test_a_stream_in_a_free_zone_is_that_of_the_driver(
    pair: tuple[ZonedStreamingRobot, InProcessStreamingRobot],
) -> None:
    robot, _ = pair
    assert robot.stream_offer().period_s > 0.0
    async with robot.stream(LIMITS) as stream:
        report = await stream.advance(robot.state().base_T_flange)
        assert report.tick >= 1
