"""The robot contract on the robot in memory and on every driver against its wire fake."""

from collections.abc import AsyncIterator

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.interfaces.robot import Robot
from drivers.robot.siasun.driver import SiasunRobot
from tests.contracts.inprocess.robot import MAX_SPEED_M_S, InProcessRobot
from tests.contracts.robot import RobotBench, RobotContract
from tests.wire.sjl_rig import Rig, sjl_rig


class InProcessBench(RobotBench):
    outside = RigidTransform.from_translation([5.0, 0.0, 0.0])
    max_speed_m_s = MAX_SPEED_M_S

    def __init__(self) -> None:
        self.memory = InProcessRobot("memory")
        self.robot: Robot = self.memory

    def commands(self) -> int:
        return self.memory.commands

    def flange(self) -> RigidTransform:
        return self.memory.flange

    def moving(self) -> bool:
        return self.memory.moving

    def freeze(self) -> None:
        self.memory.frozen_at_s = now_s()

    def cut(self) -> None:
        self.memory.cut()


class SiasunBench(RobotBench):
    outside = RigidTransform.from_translation([5.0, 0.0, 0.0])

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.robot: Robot = rig.robot
        self.max_speed_m_s = rig.settings.max_speed_mm_s / 1000
        self._started = 0
        begin = rig.arm._begin

        def counted(*arguments: object) -> None:
            self._started += 1
            begin(*arguments)  # type: ignore[arg-type]

        rig.arm._begin = counted  # type: ignore[method-assign, assignment]

    async def connect(self) -> None:
        await self.rig.connect()

    def commands(self) -> int:
        return self._started

    def flange(self) -> RigidTransform:
        return self.rig.arm.encoder_pose(self.rig.controller._clock())

    def moving(self) -> bool:
        return self.rig.arm.moving(self.rig.controller._clock())

    def freeze(self) -> None:
        self.rig.controller.faults.inject("frozen_stat")

    def cut(self) -> None:
        for wire in self.rig.wires.values():
            wire.reset()


class TestInProcessRobot(RobotContract):
    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        bench = InProcessBench()
        yield bench
        await bench.robot.disconnect()


class TestSiasunRobot(RobotContract):
    driver = SiasunRobot

    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        async with sjl_rig() as rig:
            yield SiasunBench(rig)
