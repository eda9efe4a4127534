"""What the first phases require before anything moves."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import ContactPlanInvalid, ForceLimitExceeded, TareImplausible
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.phases import (
    _reading_or_touch,
    _require_plausible,
    require_stand_off,
)
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot


@pytest.mark.parametrize("off", [(1e-3, 0.0), (0.0, 0.1), (np.nan, 0.0), (0.0, np.nan)])
def test_an_arm_that_is_elsewhere_or_nowhere_begins_no_mating(off: tuple[float, float]) -> None:
    state = SimpleNamespace(moving=False, distance_to=lambda _pose: off)
    settings = SimpleNamespace(stand_off_tolerance=(2e-4, 3e-4))
    plan = SimpleNamespace(base_T_flange=RigidTransform.identity(), settings=settings)
    with pytest.raises(ContactPlanInvalid):
        require_stand_off(cast(Robot, SimpleNamespace(state=lambda: state)), cast(MatingPlan, plan))


@pytest.mark.parametrize("component", range(6))
def test_a_zero_that_is_not_a_number_is_no_zero(component: int) -> None:
    mean = np.zeros(6)
    mean[component] = np.nan
    with pytest.raises(TareImplausible):
        _require_plausible(mean, (80.0, 40.0))


async def test_a_touch_at_standstill_is_followed_by_the_stop_of_the_daemon() -> None:
    robot, touch = StillRobot("main"), GuardTrip(TripReason.TOUCH, 1.0, "Fz 12.0 N", 2, 12.0)

    async def read(_duration_s: float, _settle_s: float) -> None:
        raise ForceLimitExceeded(touch.detail)

    settings = SimpleNamespace(reading_s=0.1, step_settle_s=0.0)
    attempt = SimpleNamespace(
        plan=SimpleNamespace(settings=settings), read=read, robot=robot, guard=TinyGuard(trip=touch)
    )
    assert await _reading_or_touch(cast(Attempt, attempt)) is None
    assert robot.stops == 1, "or its latch would be one that nobody has asked for"
