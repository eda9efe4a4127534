"""What calibrations, the robot's data sheet and the gripper's drawing say of the cell."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose

RP_OVER_SIGMA = 3.616
"""RP of ISO 9283 is the mean radius plus three of its standard deviations: for equal Gaussian axes
this multiple of the standard deviation of one axis."""


def isotropic(position_m: float, rotation_rad: float) -> Array:
    """Covariance with one standard deviation for positions, one for rotations; shape (6, 6)."""
    return np.diag([position_m**2] * 3 + [rotation_rad**2] * 3)


@dataclass(frozen=True, slots=True)
class ArmFigures:
    """How well the robot repeats and reaches poses, per axis."""

    repeatability_m: float
    """Standard deviation of the position of one approach: RP of ISO 9283 over 3.616."""
    repeatability_rad: float
    absolute_error_m: float
    """Mean distance between commanded and reached positions in the working volume."""
    drift_m: float
    """Standard deviation of what warming moves one place against another, since calibration."""

    @property
    def approach_covariance(self) -> Array:
        """Covariance of one approach of the arm, shape (6, 6)."""
        return isotropic(self.repeatability_m, self.repeatability_rad)


@dataclass(frozen=True, slots=True)
class CameraFigures:
    """What stays wrong in every look of a camera."""

    feature_bias_m: float
    """Light and chamfers move every contact of a kind by this, per axis, always alike."""
    drift_m: float
    """Standard deviation of what warming moves a camera."""
    drift_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class MountedCamera:
    """A hand-eye calibration."""

    id: str
    camera_id: str
    """Identity of the intrinsics that it was made with. Exchanging them afterwards moves what is
    measured by the difference of the principal points, which the hand-eye calibration had
    absorbed."""
    pose: UncertainPose
    """flange_T_cam1 or base_T_cam2."""


@dataclass(frozen=True, slots=True)
class DrawingIdentities:
    """Identities of what the drawings say of places; empty where a drawing is not known or not
    there."""

    plug: str = ""
    socket: str = ""
    gripper: str = ""
    plate_above: str = ""
    plate_below: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class PlugCell:
    """Everything that a scheme may use besides the looks."""

    cam1: MountedCamera
    """The camera on the flange, mounted at flange_T_cam1."""
    cam2: MountedCamera
    """Beside the robot: base_T_cam2."""
    arm: ArmFigures
    cameras: CameraFigures
    gripper: str
    """Name in the drawing of the gripper's marks, wherever its file lies."""
    flange_T_marks: RigidTransform = field(default_factory=RigidTransform.identity)
    """Pose of the gripper's marks by its drawing; its error is taught."""
    drawings: DrawingIdentities = DrawingIdentities()

    def base_T_cam1(self, base_T_flange: RigidTransform) -> RigidTransform:
        """Camera I with the flange there."""
        return base_T_flange * self.cam1.pose.pose
