"""What a driver offers to the core: one interface a file. Values are SI, frozen and time-stamped."""

from cellctl.interfaces.ft_sensor import FtHealth, FtSensor, WrenchSample
from cellctl.interfaces.robot import Robot, RobotMode, RobotState
from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair
from cellctl.interfaces.stop_channel import FlangeState, StopChannel
from cellctl.interfaces.target_tracker import Target, TargetTracker

__all__ = [
    "FlangeState",
    "FtHealth",
    "FtSensor",
    "Robot",
    "RobotMode",
    "RobotState",
    "StereoCamera",
    "StereoPair",
    "StopChannel",
    "Target",
    "TargetTracker",
    "WrenchSample",
]
