"""Every installed driver: right interface and ``Config``; this repository's own also have a full
folder and a contract class.

A driver of another distribution keeps its contract class in its own tests
(docs/writing-a-driver.md), where this module cannot see it.
"""

from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

import pytest
from pydantic import BaseModel

from cellctl.interfaces import (
    Camera,
    DigitalIo,
    FtSensor,
    Gripper,
    Robot,
    StereoCamera,
    StopChannel,
    StreamingRobot,
    TargetTracker,
)
from tests.contracts.suites.camera import CameraContract
from tests.contracts.suites.digital_io import DigitalIoContract
from tests.contracts.suites.ft_sensor import FtSensorContract
from tests.contracts.suites.gripper import GripperContract
from tests.contracts.suites.robot import RobotContract
from tests.contracts.suites.stereo_camera import StereoCameraContract
from tests.contracts.suites.stop_channel import StopChannelContract
from tests.contracts.suites.streaming_robot import StreamingRobotContract
from tests.contracts.suites.target_tracker import TargetTrackerContract

KINDS: dict[str, tuple[type, type]] = {
    "cellctl.robot": (Robot, RobotContract),
    "cellctl.stop_channel": (StopChannel, StopChannelContract),
    "cellctl.stereo_camera": (StereoCamera, StereoCameraContract),
    "cellctl.camera": (Camera, CameraContract),
    "cellctl.gripper": (Gripper, GripperContract),
    "cellctl.digital_io": (DigitalIo, DigitalIoContract),
    "cellctl.target_tracker": (TargetTracker, TargetTrackerContract),
    "cellctl.ft_sensor": (FtSensor, FtSensorContract),
}
INSTALLED = [point for group in KINDS for point in entry_points(group=group)]
OURS = [point for point in INSTALLED if point.dist is not None and point.dist.name == "cellctl"]
FILES = ("README.md", "config.py", "protocol.py", "connection.py", "driver.py", "faults.py")
WITHOUT_IO = ("asyncio", "socket", "serial", "can", "pymodbus")


def contract_classes(contract: type) -> list[type]:
    """Classes of all test modules of this folder that derive from a contract."""
    names = sorted(path.stem for path in Path(__file__).parent.glob("test_*.py"))
    modules = [import_module(f"{__package__}.{name}") for name in names]
    classes = [cls for module in modules for cls in vars(module).values() if isinstance(cls, type)]
    return [cls for cls in classes if issubclass(cls, contract)]


def described(point: EntryPoint) -> str:
    return f"{point.group}:{point.name}"


def test_every_kind_has_a_driver() -> None:
    assert {point.group for point in OURS} == set(KINDS)


@pytest.mark.parametrize("point", INSTALLED, ids=described)
def test_implements_its_interface(point: EntryPoint) -> None:
    driver = point.load()
    assert issubclass(driver, KINDS[point.group][0])
    assert not getattr(driver, "__abstractmethods__", None)
    assert issubclass(driver.Config, BaseModel)
    assert driver.Config.model_config["extra"] == "forbid"
    assert driver.Config.model_config["frozen"]
    if point.group == "cellctl.ft_sensor":
        assert driver.Config.model_fields["rate_hz"].annotation is float, "limits depend on it"


@pytest.mark.parametrize("point", OURS, ids=described)
def test_has_a_contract_class(point: EntryPoint) -> None:
    driver, contract = point.load(), KINDS[point.group][1]
    classes = contract_classes(contract)
    tested = [cls for cls in classes if getattr(cls, "driver", None) is driver]
    assert tested, f"no class with driver = {driver.__name__} derives from {contract.__name__}"
    clauses = {name for name in vars(contract) if name.startswith("test_")}
    assert not clauses & set(vars(tested[0])), "a contract clause is overridden"


def test_robots_that_can_stream_keep_that_contract_too() -> None:
    drivers = [point.load() for point in OURS if point.group == "cellctl.robot"]
    tested = {getattr(cls, "driver", None) for cls in contract_classes(StreamingRobotContract)}
    streaming = {driver for driver in drivers if issubclass(driver, StreamingRobot)}
    assert streaming <= tested


@pytest.mark.parametrize("kind", KINDS)
def test_the_contract_also_runs_in_memory(kind: str) -> None:
    names = [cls.__name__ for cls in contract_classes(KINDS[kind][1])]
    assert any("InProcess" in name for name in names)


@pytest.mark.parametrize("point", OURS, ids=described)
def test_folder(point: EntryPoint) -> None:
    source = import_module(point.module).__file__
    assert source is not None
    folder = Path(source).parent
    assert [name for name in FILES if not (folder / name).is_file()] == []
    protocol = (folder / "protocol.py").read_text(encoding="utf-8")
    assert [name for name in WITHOUT_IO if f"import {name}" in protocol] == []
