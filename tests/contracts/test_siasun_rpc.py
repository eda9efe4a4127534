"""The contracts of robot, stream and stop channel on the driver of collaborative arms."""

from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.interfaces.motion_bounds import MotionBounds
from cellctl.interfaces.stop_channel import StopChannel
from drivers.robot.siasun_rpc.driver import SiasunRpcRobot
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel
from tests.contracts.loop_thread import LoopThread
from tests.contracts.suites.robot import RobotContract
from tests.contracts.suites.robot_bench import Panel, RobotBench
from tests.contracts.suites.stop_channel import StopBench, StopChannelContract
from tests.contracts.suites.streaming_robot import StreamingBench, StreamingRobotContract
from tests.rigs.wire.duco_rig import DucoRig, duco_rig
from tests.rigs.wire.standing_arm import (
    CEILING,
    LOW_ROOM_MM,
    RATED_RAD_S_OF_FIRST,
    READY_DEG,
    TURNED_DEG,
)


class RpcBench(RobotBench):
    robot: SiasunRpcRobot
    outside = RigidTransform.from_translation([5.0, 0.0, 0.0])
    outside_joints_rad = np.radians([*READY_DEG[:5], 361.0])
    edge, beyond_edge = CEILING
    joint_speed_rad_s = RATED_RAD_S_OF_FIRST

    def __init__(self, rig: DucoRig) -> None:
        self.rig = rig
        self.robot = rig.robot
        self.max_speed_m_s = rig.settings.max_speed_mm_s / 1000

    def stated_bounds(self) -> MotionBounds:
        return SiasunRpcRobot.bounds(self.rig.settings)

    def commands(self) -> int:
        return self.rig.logic.motions

    def flange(self) -> RigidTransform:
        return self.rig.arm.encoder_pose(self.rig.logic.clock())

    def joints_rad(self) -> Array:
        return self.rig.arm.joints(self.rig.logic.clock())

    def set_panel(self, panel: Panel) -> None:
        self.rig.logic.faults.inject(
            {
                Panel.EMERGENCY_STOP: "emergency_stop",
                Panel.MANUAL: "manual_mode",
                Panel.DRIVES_OFF: "disabled",
                Panel.ERROR: "vendor_error",
            }[panel]
        )

    def turn_override_down(self) -> float:
        self.rig.logic.faults.inject("override", percent=50)
        return 0.5

    def refuse_motion(self) -> None:
        self.rig.logic.faults.inject("minus_one", count=1)

    def ignore_stops(self) -> None:
        self.rig.logic.faults.inject("stop_ignored")

    def release_at_the_panel(self) -> None:
        """The controller latches no stop: the driver's latch is the only one."""

    def moving(self) -> bool:
        return self.rig.logic.moving()

    def freeze(self) -> None:
        self.rig.logic.faults.inject("silent")

    def cut(self) -> None:
        self.rig.reset()


class RpcStreamingBench(RpcBench, StreamingBench):
    robot: SiasunRpcRobot

    def lose_setpoints(self, count: int) -> None:
        if count:
            self.rig.logic.faults.inject("servo_lost", count=count)
        else:
            self.rig.logic.faults.clear("servo_lost")

    def repeat_setpoint(self) -> None:
        # A call over TCP does not arrive twice. What is left of it is that a tick has no answer in
        # time, which is the same as a setpoint that comes late.
        self.delay_setpoint()

    def delay_setpoint(self) -> None:
        self.rig.logic.faults.inject("servo_late", count=1, delay_s=0.03)

    def silence_ticks(self) -> None:
        self.rig.logic.faults.inject("motion_silent")


class TestSiasunRpcRobot(RobotContract):
    driver = SiasunRpcRobot

    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        async with duco_rig(workspace_max_mm=LOW_ROOM_MM) as rig:
            yield RpcBench(rig)


class TestSiasunRpcStream(StreamingRobotContract):
    driver = SiasunRpcRobot

    @pytest.fixture
    async def bench(self) -> AsyncIterator[StreamingBench]:
        async with duco_rig() as rig:
            yield RpcStreamingBench(rig)


class RpcStopBench(StopBench):
    def __init__(self, thread: LoopThread, rig: DucoRig) -> None:
        self._thread = thread
        self._rig = rig
        self.channel: StopChannel = SiasunRpcStopChannel(rig.guard)

    def start_motion(self) -> None:
        target_rad = np.radians([30.0, *TURNED_DEG[1:]]).tolist()
        self._thread.call(lambda: self._rig.logic.move_joint(target_rad, 10.0))

    def moving(self) -> bool:
        return self._thread.call(self._rig.logic.moving)

    def flange(self) -> RigidTransform:
        return self._thread.call(lambda: self._rig.arm.encoder_pose(self._rig.logic.clock()))

    def flood(self) -> None:
        self._rig.rpc.back.repeat_next = 20_000

    def cut(self) -> None:
        self._thread.call(self._rig.reset)


class TestSiasunRpcStopChannel(StopChannelContract):
    driver = SiasunRpcStopChannel

    @pytest.fixture
    def bench(self) -> Iterator[StopBench]:
        with LoopThread() as thread:
            stack = AsyncExitStack()
            rig = thread.run(stack.enter_async_context(duco_rig(TURNED_DEG)))
            bench = RpcStopBench(thread, rig)
            yield bench
            bench.channel.close()
            thread.run(stack.aclose())
