"""The contract of the gripper: in memory, and every driver against its wire fake."""

from collections.abc import AsyncIterator

import pytest

from cellctl.clock import now_s
from cellctl.interfaces.gripper import Gripper
from drivers.gripper.pneumatic.driver import PneumaticGripper
from tests.contracts.inprocess.gripper import InProcessGripper
from tests.contracts.suites.gripper import GripperBench, GripperContract
from tests.wire.modbus.gripper_rig import GripperRig, gripper_rig


class InProcessBench(GripperBench):
    def __init__(self) -> None:
        self.memory = InProcessGripper("memory")
        self.gripper: Gripper = self.memory

    def take_part(self) -> None:
        self.memory.part = False

    def jam(self) -> None:
        self.memory.jammed = True

    def break_sensor(self) -> None:
        self.memory.opened_for_ever = True

    def travels(self) -> int:
        return self.memory.travels

    def shut(self) -> bool:
        return self.memory.shut

    def silence(self) -> None:
        self.memory.silent = True

    def restore(self) -> None:
        self.memory.silent = False

    def cut(self) -> None:
        self.memory.cut()


class PneumaticBench(GripperBench):
    def __init__(self, rig: GripperRig) -> None:
        self.rig = rig
        self.gripper: Gripper = rig.gripper

    def take_part(self) -> None:
        self.rig.jaws.part_present = False

    def jam(self) -> None:
        self.rig.jaws.stuck = True

    def break_sensor(self) -> None:
        self.rig.jaws.broken["opened"] = True

    def travels(self) -> int:
        return self.rig.jaws.travels

    def shut(self) -> bool:
        return self.rig.jaws.position(now_s()) > 0.75

    def silence(self) -> None:
        self.rig.coupler.faults.inject("silent")

    def restore(self) -> None:
        self.rig.coupler.faults.clear()

    def cut(self) -> None:
        self.rig.wire.reset()


class TestInProcessGripper(GripperContract):
    @pytest.fixture
    async def bench(self) -> GripperBench:
        return InProcessBench()


class TestPneumaticGripper(GripperContract):
    driver = PneumaticGripper

    @pytest.fixture
    async def bench(self) -> AsyncIterator[GripperBench]:
        async with gripper_rig() as rig:
            yield PneumaticBench(rig)
