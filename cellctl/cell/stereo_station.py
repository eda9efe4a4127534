"""A stereo head with the robot that carries it."""

from dataclasses import dataclass

from cellctl.config.devices import AuxiliaryRobot
from cellctl.interfaces import Robot, StereoCamera


@dataclass(frozen=True, slots=True)
class HeadStation:
    """Head I or head II."""

    name: str
    camera: StereoCamera
    robot: Robot
    config: AuxiliaryRobot
