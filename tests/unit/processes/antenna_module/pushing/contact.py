"""A plug on an arm that moves at once, and a guard that feels what a depth makes."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.cell.guarded_motion.guard_limits import Sensing
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.clock import now_s
from cellctl.errors.robot import MotionAborted
from cellctl.guard.health import GuardHealth
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardSample, GuardSamples, GuardTrip, TripReason
from cellctl.interfaces import Robot, RobotMode, RobotState
from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.insertion.watch import InsertionWatch
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.pushing.way import InsertionWay
from tests.unit.cell.guard import TinyGuard

SOCKET = read_connector(Path("config/connectors/micro-d-15-holes.toml"))
SEATED = RigidTransform.from_components(
    [0.5, -0.2, 0.4], Rotation.from_euler("xyz", [180.0, 0.3, 1.0], degrees=True)
)
FLANGE_T_PLUG = RigidTransform.from_components(
    [1e-4, -2e-4, 0.2], Rotation.from_euler("x", 180.0, degrees=True)
)
STAND_OFF_M = 3e-3
Wrench = Callable[[float], tuple[float, ...]]
"""What the plug feels at a depth in mm: N, N·m."""


def good(depth_mm: float) -> tuple[float, ...]:
    """Contact springs from 0.5 mm on, a seat at 2.5 mm."""
    springs_n = 24.0 * float(np.clip((depth_mm - 0.5) / 0.4, 0.0, 1.0))
    seat_n = 400.0 * max(0.0, depth_mm - 2.5)
    return (0.1, 0.0, springs_n + seat_n, 0.0, 0.0, 0.0)


@dataclass
class PlugWorld:
    """The arm with the plug, and the force of where it is."""

    wrench: Wrench = good
    seat_depth_m: float = SOCKET.seat_depth_m
    flange: RigidTransform = field(default_factory=RigidTransform.identity)
    latched: bool = False
    ready: bool = True
    targets_mm: list[float] = field(default_factory=list)
    """Depth of every target."""

    def __post_init__(self) -> None:
        self.way = InsertionWay.of(SEATED, FLANGE_T_PLUG, self.seat_depth_m)
        self.history: list[tuple[float, np.ndarray]] = []
        self.go(self.way.pose_at(-STAND_OFF_M))

    def go(self, flange: RigidTransform) -> None:
        self.flange = flange
        self.history.append((now_s(), self.felt()))

    def depth_mm(self) -> float:
        return self.way.depth_of(self.flange) * 1e3

    def felt(self) -> np.ndarray:
        return np.array(self.wrench(self.depth_mm()))


class PlugGuard(TinyGuard):
    """Trips while the arm moves beyond what is armed, and says where the wrench is."""

    def __init__(self, world: PlugWorld) -> None:
        super().__init__()
        self.world = world
        self.rng = np.random.default_rng(3)

    def samples(self, since_s: float) -> GuardSamples:
        now = now_s()
        count = max(2, int((now - since_s) * 1e3))
        noise = self.rng.normal(0.0, 0.01, (count, 6)) * [1, 1, 1, 0.02, 0.02, 0.02]
        times = np.linspace(since_s + 1e-6, now, count)
        changes, felt = zip(*self.world.history, strict=True)
        at = np.searchsorted(changes, times, side="right") - 1
        wrench = np.array(felt)[np.maximum(at, 0)] + noise
        return GuardSamples(times, wrench, wrench, np.zeros(count), overrun=False)

    def latest(self) -> GuardSample:
        wrench, now = self.world.felt(), now_s()
        return GuardSample(now, now, 1, wrench, wrench, 0.01)

    def health(self) -> GuardHealth:
        return replace(super().health(), stop_channel_up=True)

    def limit(self) -> GuardLimits:
        assert self.armed
        return self.limits[-1]


class PlugArm:
    """Reaches its target in small portions, until the guard stops it."""

    def __init__(self, world: PlugWorld, guard: PlugGuard) -> None:
        self.world, self.guard = world, guard
        self.asked: list[str] = []
        self.speeds_m_s: list[float] = []
        """Of every step."""

    def state(self, max_age_s: float = 0.25) -> RobotState:
        return RobotState(
            now_s(), self.world.flange, np.zeros(6), RobotMode.REMOTE, False, self.world.ready,
            False, self.world.latched, 0, 1.0,
        )  # fmt: skip

    async def step(self, target: RigidTransform, *, speed_m_s: float) -> RobotState:
        assert speed_m_s <= 0.4e-3 + 1e-9
        self.speeds_m_s.append(speed_m_s)
        return await self._go(target)

    async def move_linear(
        self, target: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        assert speed_m_s <= 5e-3
        return await self._go(target)

    async def stop(self) -> None:
        self.asked.append("stop")
        self.world.latched = True

    async def rearm(self) -> None:
        self.asked.append("rearm")
        self.world.latched = False

    async def _go(self, target: RigidTransform) -> RobotState:
        assert not self.world.latched
        world = self.world
        world.targets_mm.append(world.way.depth_of(target) * 1e3)
        begin, offset = world.flange, target.translation - world.flange.translation
        for share in np.linspace(0.0, 1.0, 21)[1:]:
            matrix = begin.as_matrix()
            matrix[:3, 3] += offset * share
            world.go(RigidTransform(matrix, normalize=False))
            beyond = np.flatnonzero(np.abs(world.felt()) > self.guard.limit().filtered)
            if beyond.size:
                component = int(beyond[0])
                self.guard.trip = GuardTrip(
                    TripReason.FILTERED_LIMIT, now_s(), "beyond", component, 1.0
                )
                world.latched = True
                # An arm needs a moment to stand still, and the sensor goes on sending.
                await asyncio.sleep(0.02)
                raise MotionAborted("stopped by the guard")
        return self.state()


class Push:
    """One attempt in this world, as an async context."""

    def __init__(self, world: PlugWorld, limits: InsertionLimits | None = None) -> None:
        self.world = world
        self.guard = PlugGuard(world)
        self.arm = PlugArm(world, self.guard)
        self.limits = limits or InsertionLimits.of(SOCKET)

    async def __aenter__(self) -> PushAttempt:
        robot, guard = cast(Robot, self.arm), cast(GuardPort, self.guard)
        self.recorder = ContactRecorder(robot, guard, self.world.way.depth_of)
        await self.recorder.__aenter__()
        return PushAttempt(
            robot, guard, Sensing(1000.0, 0.1, 0.3), self.world.way, SOCKET,
            self.limits, InsertionWatch(self.limits), self.recorder, settle_s=0.0, read_s=0.004,
        )  # fmt: skip

    async def __aexit__(self, *reason: Any) -> None:
        await self.recorder.__aexit__(*reason)
