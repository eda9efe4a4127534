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
    """Name of the head in the cell file."""
    camera: StereoCamera
    camera_config: StereoCameraConfig
    robot: Robot
    config: RobotConfig
    """Section of the robot in the cell file."""

    @property
    def flange_T_head(self) -> RigidTransform:
        """Nominal pose of the left camera on the flange; the flange itself where none is given."""
        written = self.camera_config.flange_T_camera
        return RigidTransform.identity() if written is None else pose_from_xyzabc(written)
