"""The tool on the flange by touching: position from four points, orientation from three.

Position: the tip touches one fixed point with four or more orientations of the flange.
Orientation: with the flange's orientation kept, the robot moves the tip from the point along the
wanted x axis of the tool, then into the half plane of x and y on the side of +y.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.checks import (
    Checks,
    LimitCheck,
    all_passed,
    checks_from_record,
    evidence_to_record,
)
from cellctl.calibration.pose_record import pose_from_record, pose_to_record
from cellctl.errors.calibration import IllConditioned, PosesNotDiverse
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose

_MIN_POSES = 4
"""Three poses that turn about different axes determine the tip; the fourth shows whether the tip
stayed on its point."""
_MIN_TURN_RAD = np.radians(10)
"""Rms turn of the flange in the weakest direction, below which the tip is hardly determined."""
MIN_TRAVEL_M = 0.02
"""Least distance of the tip from the first point: shorter ones turn the axes by more, for the same
error of the points."""
_MIN_ANGLE_RAD = np.radians(10)
"""Least angle between the two directions that the three points span."""
STILL_RAD = float(np.radians(0.1))
"""The flange keeps its orientation between the three orienting poses."""
TIP_FROM_FLANGE = "tip from the flange, less than the touched point from the base"
"""Name of the check whose limit is the distance of the touched point from the base: an arm reaches
farther than its tool is long."""
Z_FORWARDS = "z of the tool from the way out to its tip"
"""Name of the check that fails for a tool whose z points back to its flange."""
_FORWARDS_DEG = 120.0
"""A tool across the flange may point a little back; one that does by more was taught otherwise."""
_LEAST_MOVED_M = 1e-3
"""Of the flange about a tip that stays: far less than any tool is long."""


@dataclass(frozen=True, slots=True)
class ToolLimits:
    """Limits of the result."""

    residual_m: float = 3e-4
    position_sigma_m: float = 3e-4
    rotation_sigma_rad: float = float(np.radians(0.3))


@dataclass(frozen=True, slots=True)
class ToolResult:
    """A tool frame on the flange."""

    flange_T_tool: UncertainPose
    residuals_m: tuple[float, ...]
    """Distance of the tip from the common point, per pose of the position method."""
    conditioning: float
    """Ratio of the best to the worst determined direction of the tip; 1 is ideal."""
    checks: Checks
    method: str

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def to_record(self) -> dict[str, Any]:
        """Plain data for the store."""
        return {
            **evidence_to_record(self.method, self.checks),
            "flange_T_tool": pose_to_record(self.flange_T_tool),
            "residuals_mm": [value / MM for value in self.residuals_m],
            "conditioning": self.conditioning,
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "ToolResult":
        """The inverse of ``to_record``."""
        return cls(
            flange_T_tool=pose_from_record(record["flange_T_tool"]),
            residuals_m=tuple(value * MM for value in record["residuals_mm"]),
            conditioning=float(record["conditioning"]),
            checks=checks_from_record(record["checks"]),
            method=str(record["method"]),
        )


def calibrate_tool(
    touching: Sequence[RigidTransform],
    orienting: Sequence[RigidTransform] = (),
    *,
    touch_sigma_m: float = 1e-4,
    limits: ToolLimits | None = None,
) -> ToolResult:
    """flange_T_tool from poses base_T_flange.

    ``touching`` are four or more poses that touch the same point; ``orienting`` are none (the tool
    then has the flange's axes) or three: point, along x, towards +y. ``touch_sigma_m`` is the
    standard deviation of a touch, used where the residuals do not show a larger one.
    Raises ``PosesNotDiverse`` or ``IllConditioned``.
    """
    limits = limits or ToolLimits()
    position, point, covariance, residuals, conditioning = _position(touching, touch_sigma_m)
    rotation, rotation_covariance = Rotation.identity(), np.zeros((3, 3))
    method = "four-point method for the position"
    if orienting:
        rotation, rotation_covariance = _orientation(orienting, position, touch_sigma_m)
        method += ", three-point method for the orientation"
    else:
        method += "; the axes are the flange's, not measured"
    both = np.zeros((6, 6))
    both[:3, :3], both[3:, 3:] = covariance, rotation_covariance
    tool = UncertainPose(RigidTransform.from_components(position, rotation), both)
    checks: Checks = (
        LimitCheck("largest residual", residuals.max() / MM, limits.residual_m / MM, "mm"),
        LimitCheck("position sigma", tool.sigma[:3].max() / MM, limits.position_sigma_m / MM, "mm"),
        # Inverted poses fit as well as the right ones, with tip and touched point exchanged: only
        # their lengths tell which is which.
        LimitCheck(TIP_FROM_FLANGE, _length_mm(position), _length_mm(point), "mm"),
    )
    # What was not measured has no sigma that could pass or fail.
    if orienting:
        sigma_deg, limit_deg = np.degrees((tool.sigma[3:].max(), limits.rotation_sigma_rad))
        checks += (LimitCheck("rotation sigma", float(sigma_deg), float(limit_deg), "°"),)
        back_deg = _z_from_way_out_deg(tool.pose)
        checks += (LimitCheck(Z_FORWARDS, back_deg, _FORWARDS_DEG, "°"),)
    return ToolResult(tool, tuple(residuals.tolist()), conditioning, checks, method)


def _z_from_way_out_deg(flange_T_tool: RigidTransform) -> float:
    """Angle between the z axis and the way from the flange to the tip; 0 where there is no way."""
    z_axis, tip_m = flange_T_tool.rotation.as_matrix()[:, 2], flange_T_tool.translation
    across, along = np.linalg.norm(np.cross(z_axis, tip_m)), z_axis @ tip_m
    return float(np.degrees(np.arctan2(across, along)))


def _position(
    poses: Sequence[RigidTransform], touch_sigma_m: float
) -> tuple[Array, Array, Array, Array, float]:
    """Tip in the flange, the touched point in the base, covariance of the tip, the residual per
    pose, and the conditioning.

    R_i t + p_i = c for all poses: linear in the tip t and the point c.
    """
    if len(poses) < _MIN_POSES:
        raise PosesNotDiverse(f"{len(poses)} touching poses, at least {_MIN_POSES} needed")
    rotations = np.stack([pose.rotation.as_matrix() for pose in poses])
    places = np.stack([pose.translation for pose in poses])
    # With c eliminated only deviations from the mean rotation tell about t.
    spread = (rotations - rotations.mean(axis=0)).reshape(-1, 3)
    singular = np.linalg.svd(spread / np.sqrt(len(poses)), compute_uv=False)
    # The weakest direction decides: turns about one direction leave the tip free along it.
    if singular[-1] < np.sin(_MIN_TURN_RAD):
        raise PosesNotDiverse(
            f"the flange turns too little or about one direction only "
            f"({np.degrees(np.arcsin(min(1.0, singular[-1]))):.1f}° rms, 10° needed)"
        )
    # Turned about its own middle the flange gives a tool without length, with residuals of zero.
    moved_m = float(np.linalg.norm(places - places.mean(axis=0), axis=1).max())
    if moved_m < _LEAST_MOVED_M:
        raise PosesNotDiverse(
            f"the flange stands within {moved_m / MM:.2f} mm in all touching poses and only turns: "
            "no tip stays on a point so; turn it about the tip, or its positions were not read"
        )
    design = np.concatenate(
        [rotations.reshape(-1, 3), np.tile(-np.eye(3), (len(poses), 1))], axis=1
    )
    solution = np.linalg.lstsq(design, -places.ravel(), rcond=None)[0]
    residuals = (design @ solution + places.ravel()).reshape(-1, 3)
    # Six unknowns: the tip in the flange and the point in the base.
    estimated = float(np.sqrt((residuals**2).sum() / (3 * len(poses) - 6)))
    # Four poses may fit by luck: never believe less than the touch itself is uncertain.
    sigma_m = max(estimated, touch_sigma_m)
    covariance = np.linalg.inv(design.T @ design)[:3, :3] * sigma_m**2
    distances = np.linalg.norm(residuals, axis=1)
    conditioning = float(singular[0] / singular[-1])
    return solution[:3], solution[3:], covariance, distances, conditioning


def _length_mm(place_m: Array) -> float:
    return float(np.linalg.norm(place_m)) / MM


def _orientation(
    poses: Sequence[RigidTransform], position_m: Array, touch_sigma_m: float
) -> tuple[Rotation, Array]:
    """flange_R_tool and the covariance of its small rotation in the flange's axes."""
    if len(poses) != 3:
        raise PosesNotDiverse(f"the orientation needs three poses, got {len(poses)}")
    turns = [(pose.rotation * poses[0].rotation.inv()).magnitude() for pose in poses]
    if max(turns) > STILL_RAD:
        raise PosesNotDiverse(
            f"the flange turned by {np.degrees(max(turns)):.2f}° between the orientation poses"
        )
    tips = np.stack([pose.apply(position_m) for pose in poses])
    to_flange = poses[0].rotation.inv()
    rotation = to_flange * _axes(tips)
    jacobian = np.zeros((3, 9))
    step = 1e-7  # m: far below the 20 mm and more between the points, far above rounding
    for index in range(9):
        change = (step * np.eye(9)[index]).reshape(3, 3)
        turn = to_flange * _axes(tips + change) * rotation.inv()
        jacobian[:, index] = turn.as_rotvec() / step
    return rotation, jacobian @ jacobian.T * touch_sigma_m**2


def _axes(tips: Array) -> Rotation:
    """Axes in the base: x from the first to the second tip, the third on the side of +y."""
    x, other = tips[1] - tips[0], tips[2] - tips[0]
    length, second = float(np.linalg.norm(x)), float(np.linalg.norm(other))
    if min(length, second) < MIN_TRAVEL_M:
        raise IllConditioned(f"move the tip by at least {MIN_TRAVEL_M / MM:.0f} mm between points")
    x = x / length
    y = other - (other @ x) * x
    if float(np.linalg.norm(y)) < second * np.sin(_MIN_ANGLE_RAD):
        raise IllConditioned("the three points lie nearly on a line")
    y = y / np.linalg.norm(y)
    return Rotation.from_matrix(np.stack([x, y, np.cross(x, y)], axis=1))
