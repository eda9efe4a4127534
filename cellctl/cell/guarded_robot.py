"""A robot with the force sensor on its flange and the guard that watches it."""

from dataclasses import dataclass
from pathlib import Path

from scipy.spatial.transform import RigidTransform

from cellctl.config.devices import ForceSensorConfig, RobotConfig
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.client import GuardClient
from cellctl.interfaces import Robot


@dataclass(frozen=True, slots=True)
class GuardedRobot:
    """What a move under force limits works with."""

    robot: Robot
    config: RobotConfig
    sensor_name: str
    """Name of the force sensor in the cell file; its guard has the same name."""
    guard: GuardClient
    sensor: ForceSensorConfig
    zero_file: Path | None = None
    """Where a zero that hides a part in its place is kept over a restart; None: nowhere."""

    @property
    def flange_T_sensor(self) -> RigidTransform:
        """Pose of the sensor in the flange, as the cell file has it."""
        return pose_from_xyzabc(self.sensor.flange_T_sensor)
