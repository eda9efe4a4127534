"""The robot contract on the robot in memory and on every driver against its wire fake."""

from collections.abc import AsyncIterator

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.robot_layers.noted_robot import RobotNotes
from cellctl.cell.zones.arbiter import ZoneArbiter
from cellctl.cell.zones.zone import Share, Zone
from cellctl.cell.zones.zoned_robot import ZonedRobot
from cellctl.clock import now_s
from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot, StreamingRobot
from cellctl.interfaces.motion_bounds import MotionBounds
from cellctl.interfaces.robot import RobotMode
from drivers.robot.siasun.driver import SiasunRobot
from tests.contracts.inprocess.robot import (
    AT_REACH,
    MAX_SPEED_M_S,
    RATED_RAD_S,
    InProcessRobot,
)
from tests.contracts.inprocess.streaming_robot import InProcessStreamingRobot
from tests.contracts.suites.robot import RobotContract
from tests.contracts.suites.robot_bench import Panel, RobotBench
from tests.contracts.suites.streaming_robot import StreamingBench, StreamingRobotContract
from tests.rigs.wire.job_rig import JobRig, job_rig
from tests.rigs.wire.sjl_rig import Rig, sjl_rig
from tests.rigs.wire.standing_arm import CEILING, LOW_ROOM_MM, RATED_RAD_S_OF_FIRST, READY_DEG


class InProcessBench(RobotBench):
    outside = RigidTransform.from_translation([5.0, 0.0, 0.0])
    outside_joints_rad = np.array([0.0, 0.0, 3.2, 0.0, 0.0, 0.0])
    edge, beyond_edge = AT_REACH
    max_speed_m_s = MAX_SPEED_M_S
    joint_speed_rad_s = RATED_RAD_S

    def __init__(self, memory: InProcessRobot, robot: Robot | None = None) -> None:
        """``robot``: what stands before the robot in memory, if anything does."""
        self.memory = memory
        self.robot = memory if robot is None else robot

    def stated_bounds(self) -> MotionBounds:
        return InProcessRobot.bounds(None)

    def commands(self) -> int:
        return self.memory.commands

    def flange(self) -> RigidTransform:
        return self.memory.flange

    def joints_rad(self) -> Array:
        return self.memory.joints_rad

    def set_panel(self, panel: Panel) -> None:
        self.memory.emergency_stop = panel is Panel.EMERGENCY_STOP
        self.memory.drives_on = panel is not Panel.DRIVES_OFF
        self.memory.mode = RobotMode.MANUAL if panel is Panel.MANUAL else RobotMode.REMOTE
        self.memory.error_code = 7 if panel is Panel.ERROR else 0

    def turn_override_down(self) -> float:
        self.memory.override_ratio = 0.5
        return 0.5

    def refuse_motion(self) -> None:
        self.memory.refuses = True

    def ignore_stops(self) -> None:
        self.memory.deaf = True

    def release_at_the_panel(self) -> None:
        """Its only latch is the driver's."""

    def moving(self) -> bool:
        return self.memory.moving

    def freeze(self) -> None:
        self.memory.frozen_at_s = now_s()

    def cut(self) -> None:
        self.memory.cut()


class SiasunBench(RobotBench):
    robot: SiasunRobot
    outside = RigidTransform.from_translation([5.0, 0.0, 0.0])
    outside_joints_rad = np.radians([*READY_DEG[:5], 361.0])
    edge, beyond_edge = CEILING
    joint_speed_rad_s = RATED_RAD_S_OF_FIRST

    def __init__(self, rig: Rig | JobRig) -> None:
        self.rig = rig
        self.robot = rig.robot
        self.max_speed_m_s = rig.settings.max_speed_mm_s / 1000
        self._started = 0
        begin = rig.arm._begin

        def counted(*arguments: object) -> None:
            self._started += 1
            begin(*arguments)  # type: ignore[arg-type]

        rig.arm._begin = counted  # type: ignore[method-assign, assignment]

    async def connect(self) -> None:
        await self.rig.connect()

    def stated_bounds(self) -> MotionBounds:
        return SiasunRobot.bounds(self.rig.settings)

    def commands(self) -> int:
        return self._started

    def flange(self) -> RigidTransform:
        return self.rig.arm.encoder_pose(self.rig.controller._clock())

    def joints_rad(self) -> Array:
        return self.rig.arm.joints(self.rig.controller._clock())

    def set_panel(self, panel: Panel) -> None:
        self.rig.controller.faults.inject(
            {
                Panel.EMERGENCY_STOP: "emergency_stop",
                Panel.MANUAL: "manual_mode",
                Panel.DRIVES_OFF: "drives_off",
                Panel.ERROR: "vendor_error",
            }[panel]
        )

    def turn_override_down(self) -> float:
        self.rig.controller.faults.inject("override_zero")
        return 0.0

    def refuse_motion(self) -> None:
        self.rig.controller.faults.inject("reject", count=1)

    def ignore_stops(self) -> None:
        self.rig.controller.faults.inject("ignore_stop")

    def release_at_the_panel(self) -> None:
        self.rig.release_latch()

    def moving(self) -> bool:
        return self.rig.controller.moving()

    def freeze(self) -> None:
        self.rig.controller.faults.inject("frozen_stat")

    def cut(self) -> None:
        for wire in self.rig.wires.values():
            wire.reset()


class InProcessStreamingBench(InProcessBench, StreamingBench):
    memory: InProcessStreamingRobot
    robot: StreamingRobot

    def __init__(
        self, memory: InProcessStreamingRobot, robot: StreamingRobot | None = None
    ) -> None:
        super().__init__(memory, robot)

    def lose_setpoints(self, count: int) -> None:
        self.memory.losses = count

    def repeat_setpoint(self) -> None:
        self.memory.late += 1

    def delay_setpoint(self) -> None:
        self.memory.late += 1

    def silence_ticks(self) -> None:
        self.memory.silent = True


class SiasunStreamingBench(SiasunBench, StreamingBench):
    robot: SiasunRobot

    def lose_setpoints(self, count: int) -> None:
        if count:
            self.rig.controller.faults.inject("set_lost", count=count)
        else:
            self.rig.controller.faults.clear("set_lost")

    def repeat_setpoint(self) -> None:
        self.rig.controller.faults.inject("set_repeated", count=1)

    def delay_setpoint(self) -> None:
        self.rig.controller.faults.inject("set_late", count=1)

    def silence_ticks(self) -> None:
        self.rig.controller.faults.inject("ticks_silent")


class TestInProcessRobot(RobotContract):
    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        bench = InProcessBench(InProcessRobot("memory"))
        yield bench
        await bench.robot.disconnect()


class TestZonedRobot(RobotContract):
    """What stands before the drivers of robots that share a zone keeps their contract."""

    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        memory, other = InProcessRobot("memory"), InProcessRobot("other")
        other.flange = RigidTransform.from_translation([-1.5, 0.0, 1.0])
        share = Share(Box(np.array([0.0, -1.0, 0.0]), np.array([2.0, 1.0, 2.0])), ())
        zone = Zone("all", {"memory": share, "other": share}, 1.0)
        arbiter = ZoneArbiter((zone,), {"memory": memory.state, "other": other.state})
        async with other:
            bench = InProcessBench(memory, ZonedRobot(memory, arbiter, None))
            yield bench
            await bench.robot.disconnect()


class TestNotedRobot(RobotContract):
    """The layer that takes notes for the record of a run keeps the contract, too."""

    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        memory = InProcessRobot("memory")
        bench = InProcessBench(memory, RobotNotes().noted(memory))
        yield bench
        await bench.robot.disconnect()


class TestSiasunRobot(RobotContract):
    driver = SiasunRobot

    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        async with sjl_rig(workspace_max_mm=LOW_ROOM_MM) as rig:
            yield SiasunBench(rig)


class TestSiasunRobotOnItsJobs(RobotContract):
    """The same driver, with the shipped job files at the other end."""

    driver = SiasunRobot

    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        async with job_rig(workspace_max_mm=LOW_ROOM_MM) as rig:
            yield SiasunBench(rig)


class TestInProcessStreamingRobot(StreamingRobotContract):
    @pytest.fixture
    async def bench(self) -> AsyncIterator[StreamingBench]:
        bench = InProcessStreamingBench(InProcessStreamingRobot("memory"))
        yield bench
        await bench.robot.disconnect()


class TestSiasunStream(StreamingRobotContract):
    driver = SiasunRobot

    @pytest.fixture
    async def bench(self) -> AsyncIterator[StreamingBench]:
        async with sjl_rig() as rig:
            yield SiasunStreamingBench(rig)
