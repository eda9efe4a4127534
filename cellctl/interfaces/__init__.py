"""What a driver offers to the core: one interface a file. Values are SI, frozen and time-stamped.

Names are looked up when they are used: the guard imports two of these modules and must not load
the arrays that the others need (cellctl/guard/watch).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cellctl.interfaces.arm_load import ArmLoad, PendantSelection
    from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
    from cellctl.interfaces.digital_io import DigitalIo, DigitalIoState, IoNames
    from cellctl.interfaces.ft_sensor import FtHealth, FtSensor, WrenchSample
    from cellctl.interfaces.gripper import Gripper, GripperState
    from cellctl.interfaces.motion_bounds import MotionBounds
    from cellctl.interfaces.robot import Robot, RobotMode, RobotState
    from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair
    from cellctl.interfaces.stop_channel import FlangeState, StopChannel
    from cellctl.interfaces.streaming_robot import (
        PoseStream,
        StreamingRobot,
        StreamLimits,
        StreamOffer,
        StreamReport,
    )
    from cellctl.interfaces.target_tracker import Target, TargetTracker

__all__ = [
    "ArmLoad",
    "Camera",
    "CameraImage",
    "DigitalIo",
    "DigitalIoState",
    "FlangeState",
    "FtHealth",
    "FtSensor",
    "Gripper",
    "GripperState",
    "IoNames",
    "MotionBounds",
    "PendantSelection",
    "PixelFormat",
    "PoseStream",
    "Robot",
    "RobotMode",
    "RobotState",
    "StereoCamera",
    "StereoPair",
    "StopChannel",
    "StreamLimits",
    "StreamOffer",
    "StreamReport",
    "StreamingRobot",
    "Target",
    "TargetTracker",
    "WrenchSample",
]

_MODULES = {
    "arm_load": ("ArmLoad", "PendantSelection"),
    "camera": ("Camera", "CameraImage", "PixelFormat"),
    "digital_io": ("DigitalIo", "DigitalIoState", "IoNames"),
    "ft_sensor": ("FtHealth", "FtSensor", "WrenchSample"),
    "gripper": ("Gripper", "GripperState"),
    "motion_bounds": ("MotionBounds",),
    "robot": ("Robot", "RobotMode", "RobotState"),
    "stereo_camera": ("StereoCamera", "StereoPair"),
    "stop_channel": ("FlangeState", "StopChannel"),
    "streaming_robot": (
        "PoseStream",
        "StreamLimits",
        "StreamOffer",
        "StreamReport",
        "StreamingRobot",
    ),
    "target_tracker": ("Target", "TargetTracker"),
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
