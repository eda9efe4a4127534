"""A stereo head with the robot that carries it."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.config.devices import RobotConfig, StereoCameraConfig
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces import Robot, StereoCamera


@dataclass(frozen=True, slots=True)
class StereoStation:
    """What a measurement or a calibration of one head works with."""

    name: str
    """Of the head."""
    camera: StereoCamera
    camera_config: StereoCameraConfig
    robot: Robot
    config: RobotConfig
    """Of the robot."""

    @property
    def flange_T_head(self) -> RigidTransform:
        """Nominal pose of the left camera on the flange; the flange itself where none is given."""
        written = self.camera_config.flange_T_camera
        return RigidTransform.identity() if written is None else pose_from_xyzabc(written)
