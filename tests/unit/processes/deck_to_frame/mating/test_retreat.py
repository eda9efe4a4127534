"""Who may take the deck off the frame unasked: the mating, after its own faults, nobody else."""

import asyncio
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.errors.base import CellError
from cellctl.errors.force import (
    FlangePoseStale,
    GuardDied,
    GuardRefused,
    LiftOffHeld,
    NotSettled,
    SensorFrozen,
    SensorSilent,
)
from cellctl.errors.link import LinkLost
from cellctl.errors.robot import MotionAborted, RobotNotReady, StopFailed
from cellctl.force.contact.curve import ForceCurve
from cellctl.guard.health import GuardHealth
from cellctl.guard.limits import CusumTouch
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import RobotMode
from cellctl.processes.deck_to_frame.faults import ContactEarly, MatingOverforce
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.back_off import back_off
from cellctl.processes.deck_to_frame.mating.retreat import retreat
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot
from tests.unit.processes.deck_to_frame.mating.test_plan import plan
from tests.unit.processes.deck_to_frame.rig import curve

TRAVEL_M = 0.009


@dataclass
class Guard(TinyGuard):
    """Says how well it is."""

    well: GuardHealth = field(default_factory=lambda: GuardHealth(alive=True, stop_channel_up=True))

    def health(self) -> GuardHealth:
        return self.well


class Scene:
    """Stopped on the way down, latched by the guard's stop."""

    def __init__(self, **looks: Any) -> None:
        self.plan = plan()
        self.robot = StillRobot("main", flange=self.plan.pose_at(TRAVEL_M), looks=looks)
        self.guard = self.robot.watched_by = Guard()
        recorder = SimpleNamespace(curve=curve, travel_at=lambda _: TRAVEL_M)
        self.attempt = Attempt(
            self.robot, self.guard, self.plan, cast(ContactRecorder, recorder), lambda _: None
        )

    async def after(self, fault: CellError) -> CellError:
        await retreat(self.attempt, fault)
        assert self.robot.stops == 1, "stopped in any case"
        return fault

    @property
    def stayed(self) -> bool:
        """No move, and nobody released a latch."""
        return not self.robot.moves and self.robot.latched and not self.guard.asked


@pytest.mark.parametrize("fault", [ContactEarly(""), MatingOverforce(""), SensorSilent("")])
async def test_after_its_own_faults_it_backs_off_by_two_millimetres(fault: CellError) -> None:
    scene = Scene()
    await scene.after(fault)
    assert [move.kind for move in scene.robot.moves] == ["linear"] * 2
    assert scene.robot.moves[0].speed < scene.plan.settings.back_off_speed_m_s
    target = cast(RigidTransform, scene.robot.moves[1].target)
    assert TRAVEL_M - scene.plan.travel_of(target) == pytest.approx(scene.plan.settings.back_off_m)
    assert isinstance(getattr(fault, "curve", None), ForceCurve)


@pytest.mark.parametrize(
    "fault",
    [
        MotionAborted("STOP by the panel"),
        RobotNotReady("mode MANUAL"),
        LinkLost("main"),
        StopFailed("main"),
        GuardDied("killed"),
        GuardRefused("a trip is latched"),
        FlangePoseStale("300 ms"),
        NotSettled("swings"),
    ],
)
async def test_after_any_other_fault_the_arm_stays_stopped(fault: CellError) -> None:
    scene = Scene()
    await scene.after(fault)
    assert scene.stayed


@pytest.mark.parametrize(
    "looks",
    [
        {"mode": RobotMode.MANUAL},
        {"drives_on": False},
        {"emergency_stop": True},
        {"error_code": 7},
    ],
)
async def test_a_robot_that_somebody_has_taken_over_stays_stopped(looks: dict[str, Any]) -> None:
    scene = Scene(**looks)
    await scene.after(MatingOverforce("46 N"))
    assert scene.stayed


@pytest.mark.parametrize(
    "well", [GuardHealth(alive=False), GuardHealth(alive=True, stop_channel_up=False)]
)
async def test_without_a_guard_that_could_stop_it_nothing_moves(well: GuardHealth) -> None:
    scene = Scene()
    scene.guard.well = well
    await scene.after(MatingOverforce("46 N"))
    assert scene.stayed


async def test_a_stop_that_is_not_confirmed_ends_the_retreat() -> None:
    scene = Scene()
    scene.robot.faults["stop"] = StopFailed("main")
    fault = await scene.after(MatingOverforce("46 N"))
    assert scene.stayed
    assert "while retreating: F304" in fault.__notes__[0]


async def test_nothing_that_can_fail_stands_before_the_stop() -> None:
    scene = Scene()

    def no_memory() -> ForceCurve:
        raise MemoryError

    scene.attempt.recorder = cast(ContactRecorder, SimpleNamespace(curve=no_memory))
    with pytest.raises(MemoryError):
        await retreat(scene.attempt, MatingOverforce("Fz 46 N"))
    assert scene.robot.stops == 1


async def test_what_presses_may_go_but_not_grow_and_nothing_may_pull() -> None:
    scene = Scene()
    scene.guard.raw = scene.guard.raw + np.array([0.0, 8.0, 44.0, 0.0, 0.0, 3.0])
    await scene.after(MatingOverforce("46 N"))
    settings, (limits,) = scene.plan.settings, scene.guard.limits
    assert limits.filtered[2] == pytest.approx(44.0 + settings.fast_limit_n, abs=0.5)
    assert limits.filtered[1] == pytest.approx(8.0 + settings.fast_limit_n, abs=0.5)
    assert limits.touch == CusumTouch(
        settings.fast_limit_n, settings.touch.threshold_n, axis=2, sign=-1.0
    )
    assert scene.guard.asked == ["acknowledge", "arm", "disarm"]


async def test_without_live_readings_it_stays_where_it_stopped() -> None:
    scene = Scene()
    scene.guard.raw = np.zeros((200, 6))
    fault = await scene.after(SensorFrozen("10 samples"))
    assert not scene.robot.moves
    assert "while retreating: F504" in fault.__notes__[0]


@pytest.mark.parametrize(
    ("reason", "found"),
    [(TripReason.TOUCH, LiftOffHeld), (TripReason.SENSOR_SILENT, SensorSilent)],
)
async def test_a_trip_on_the_way_back_ends_it(reason: TripReason, found: type[CellError]) -> None:
    scene = Scene()
    scene.robot.latched = False
    scene.robot.road_is_free = asyncio.Event()
    backing = asyncio.create_task(back_off(scene.attempt))
    await scene.robot.on_the_way.wait()
    scene.guard.trip = GuardTrip(reason, 1.0, "Fz -25.0 N", 2)
    async with asyncio.timeout(1.0):
        while not scene.robot.stops:  # noqa: ASYNC110  the second stop, which ends the move
            await asyncio.sleep(0.001)
    scene.robot.road_is_free.set()
    with pytest.raises(found):
        await backing
    assert len(scene.robot.moves) == 1
    assert scene.guard.asked[-1] == "arm", "still watching"
