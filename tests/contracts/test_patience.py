"""What stands before drivers that may hang keeps the contract of each kind of device."""

from collections.abc import AsyncIterator

import pytest

from cellctl.cell.patience.patient_devices import (
    PatientCamera,
    PatientGripper,
    PatientHead,
    PatientIo,
    PatientTracker,
)
from cellctl.cell.patience.patient_robot import PatientRobot, PatientStreamingRobot
from cellctl.interfaces import PixelFormat
from tests.contracts import test_cameras, test_digital_io, test_grippers, test_heads, test_robots
from tests.contracts.inprocess.robot import InProcessRobot
from tests.contracts.inprocess.streaming_robot import InProcessStreamingRobot
from tests.contracts.suites.camera import CameraContract, SingleCameraBench
from tests.contracts.suites.digital_io import DigitalIoBench, DigitalIoContract
from tests.contracts.suites.gripper import GripperBench, GripperContract
from tests.contracts.suites.robot import RobotContract
from tests.contracts.suites.robot_bench import RobotBench
from tests.contracts.suites.stereo_camera import StereoCameraBench, StereoCameraContract
from tests.contracts.suites.streaming_robot import StreamingBench, StreamingRobotContract
from tests.contracts.suites.target_tracker import TargetTrackerContract, TrackerBench


class TestPatientRobot(RobotContract):
    @pytest.fixture
    async def bench(self) -> AsyncIterator[RobotBench]:
        memory = InProcessRobot("memory")
        yield test_robots.InProcessBench(memory, PatientRobot(memory))
        await memory.disconnect()


class TestPatientStreamingRobot(StreamingRobotContract):
    @pytest.fixture
    async def bench(self) -> AsyncIterator[StreamingBench]:
        memory = InProcessStreamingRobot("memory")
        yield test_robots.InProcessStreamingBench(memory, PatientStreamingRobot(memory))
        await memory.disconnect()


class TestPatientCamera(CameraContract):
    @pytest.fixture
    async def bench(self) -> SingleCameraBench:
        bench = test_cameras.InProcessBench(PixelFormat.MONO8)
        bench.camera = PatientCamera(bench.camera)
        return bench


class TestPatientHead(StereoCameraContract):
    @pytest.fixture
    async def bench(self) -> StereoCameraBench:
        bench = test_heads.InProcessCameraBench()
        bench.camera = PatientHead(bench.camera)
        return bench


class TestPatientTracker(TargetTrackerContract):
    @pytest.fixture
    async def bench(self) -> TrackerBench:
        bench = test_heads.InProcessTrackerBench()
        bench.tracker = PatientTracker(bench.tracker)
        return bench


class TestPatientGripper(GripperContract):
    @pytest.fixture
    async def bench(self) -> GripperBench:
        bench = test_grippers.InProcessBench()
        bench.gripper = PatientGripper(bench.gripper)
        return bench


class TestPatientIo(DigitalIoContract):
    @pytest.fixture
    def bench(self) -> DigitalIoBench:
        bench = test_digital_io.InProcessBench()
        bench.io = PatientIo(bench.io)
        return bench
