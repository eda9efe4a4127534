"""The main robot's base in the large-field head, from turning A1 and A2 (section 2.1.2, fig. 2).

A1 is the z axis of the base. A2 is at right angles to it, at height ``d1`` and radius ``a1``: the
foot of the common perpendicular on A1 lies ``d1`` above the origin, and A2's direction, turned
back by the angle of A1, is the y axis.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.arm_reference import ArmReference
from cellctl.calibration.checks import (
    Checks,
    LimitCheck,
    all_passed,
    checks_from_record,
    evidence_to_record,
)
from cellctl.calibration.pose_record import pose_from_record, pose_to_record
from cellctl.calibration.solvers.base_frame.axis_fit import ArmNoise, AxisFit, AxisStop, fit_axis
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose

ADVISED_ARC_RAD = np.pi / 2
"""Arc of each axis below which a warning is given. Simulated with one target at 1.5 m and 0.05 mm
of noise, arcs of 30, 60 and 90° give the direction of an axis to 0.053, 0.014 and 0.006°."""


@dataclass(frozen=True, slots=True)
class ArmGeometry:
    """First links of the robot. With all signs +1: A1 turns about +z of the base, A2 about +y."""

    d1_m: float
    """Height of A2 above the base."""
    a1_m: float
    """Distance of A2 from A1, along x when A1 is at zero."""
    a1_sign: int = 1
    a2_sign: int = 1
    a1_zero_rad: float = 0.0
    """Angle of the arm about z when A1 reads zero."""


@dataclass(frozen=True, slots=True)
class BaseFrameLimits:
    """Limits of the result."""

    rms_m: float = 1.5e-4
    a1_error_m: float = 2e-3
    squareness_rad: float = float(np.radians(0.1))
    position_sigma_m: float = 2e-4
    rotation_sigma_rad: float = float(np.radians(0.01))
    arc_rad: float = float(np.radians(30))


@dataclass(frozen=True, slots=True)
class BaseFrameResult:
    """The base frame and how it was found."""

    c_T_base: UncertainPose
    """C_T_B of the paper."""
    a1_m: float
    """Measured distance between the two axes."""
    squareness_rad: float
    """Angle between the axes less 90°."""
    residuals_m: Mapping[str, float]
    """Distance of each point from its adjusted place: ``A1 3:F2`` is target F2 at stop 3."""
    arcs_rad: tuple[float, float]
    checks: Checks
    warnings: tuple[str, ...]
    method: str = "joint fit of the A1 and A2 axes with commanded angles"
    reference: ArmReference | None = None
    """Targets in the middle of both arcs, to notice later that the arm was moved."""
    axes: tuple[AxisFit, AxisFit] | None = None
    """The two axes as fitted, for the picture; they are not in the record."""

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def to_record(self) -> dict[str, Any]:
        """Plain data for the store."""
        kept = {} if self.reference is None else {"reference": self.reference.to_record()}
        return {
            **kept,
            **evidence_to_record(self.method, self.checks, self.warnings),
            "c_T_base": pose_to_record(self.c_T_base),
            "a1_mm": self.a1_m / MM,
            "squareness_deg": float(np.degrees(self.squareness_rad)),
            "arcs_deg": np.degrees(self.arcs_rad).tolist(),
            "residuals_mm": {name: value / MM for name, value in self.residuals_m.items()},
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "BaseFrameResult":
        """The inverse of ``to_record``."""
        first, second = np.radians(record["arcs_deg"])
        # Records of offline solutions, and of earlier versions, have none.
        kept = record.get("reference")
        return cls(
            c_T_base=pose_from_record(record["c_T_base"]),
            a1_m=record["a1_mm"] * MM,
            squareness_rad=float(np.radians(record["squareness_deg"])),
            residuals_m={name: value * MM for name, value in record["residuals_mm"].items()},
            arcs_rad=(float(first), float(second)),
            checks=checks_from_record(record["checks"]),
            warnings=tuple(record["warnings"]),
            method=str(record["method"]),
            reference=ArmReference.from_record(kept) if kept is not None else None,
        )


def calibrate_base_frame(
    a1_stops: Sequence[AxisStop],
    a2_stops: Sequence[AxisStop],
    arm: ArmGeometry,
    *,
    noise: ArmNoise | None = None,
    limits: BaseFrameLimits | None = None,
) -> BaseFrameResult:
    """C_T_B from stops that turn A1 alone and stops that turn A2 alone.

    Raises ``AxisMotionInvalid``. Arcs below 90° and single targets are warned of: the direction of
    an axis gets uncertain with the square of the arc.
    """
    noise, limits = noise or ArmNoise(), limits or BaseFrameLimits()
    first = fit_axis(a1_stops, 0, arm.a1_sign, noise)
    second = fit_axis(a2_stops, 1, arm.a2_sign, noise)
    a1_angle_rad = arm.a1_sign * float(a2_stops[0].joints_rad[0]) + arm.a1_zero_rad
    lines = np.concatenate([first.direction, first.point_m, second.direction, second.point_m])
    pose = _base(lines, arm.d1_m, a1_angle_rad)
    c_T_base = UncertainPose(pose, _covariance(lines, (first, second), arm.d1_m, a1_angle_rad))
    # Not used for the frame itself: a1 and squareness check it against the data sheet.
    link_x = (pose.rotation * Rotation.from_euler("z", a1_angle_rad)).apply([1.0, 0.0, 0.0])
    a1_m = float((second.point_m - first.point_m) @ link_x)
    squareness_rad = float(np.arccos(first.direction @ second.direction) - np.pi / 2)
    return BaseFrameResult(
        c_T_base=c_T_base,
        a1_m=a1_m,
        squareness_rad=squareness_rad,
        residuals_m=_residuals(first, second),
        arcs_rad=(first.arc_rad, second.arc_rad),
        checks=_checks(
            c_T_base,
            first,
            second,
            a1_error_m=a1_m - arm.a1_m,
            squareness_rad=squareness_rad,
            limits=limits,
        ),
        warnings=(*_warnings("A1", first), *_warnings("A2", second)),
        axes=(first, second),
    )


def _base(lines: Array, d1_m: float, a1_angle_rad: float) -> RigidTransform:
    """The base frame from direction and point of A1, then of A2, shape (12,)."""
    z_axis, point_1, a2_axis, point_2 = lines.reshape(4, 3)
    z = z_axis / np.linalg.norm(z_axis)
    a2_axis = a2_axis / np.linalg.norm(a2_axis)
    # The axes are square only to the tolerance of the arm. A1 keeps its direction as z, and of A2
    # the direction across z is used.
    y = a2_axis - (a2_axis @ z) * z
    y = y / np.linalg.norm(y)
    link = Rotation.from_matrix(np.stack([np.cross(y, z), y, z], axis=1))
    # Foot of the common perpendicular on A1: where the two lines come nearest.
    cosine = z @ a2_axis
    apart = point_2 - point_1
    along = (apart @ z - cosine * (apart @ a2_axis)) / (1 - cosine**2)
    origin = point_1 + (along - d1_m) * z
    return RigidTransform.from_components(origin, link * Rotation.from_euler("z", -a1_angle_rad))


def _covariance(
    lines: Array, fits: tuple[AxisFit, AxisFit], d1_m: float, a1_angle_rad: float
) -> Array:
    """Covariance of C_T_B, by central differences over the two lines."""
    jacobian = np.zeros((6, 12))
    step = 1e-6  # m or rad: far above rounding, far below any curvature
    for index in range(12):
        change = step * np.eye(12)[index]
        high = _base(lines + change, d1_m, a1_angle_rad)
        low = _base(lines - change, d1_m, a1_angle_rad)
        jacobian[:3, index] = (high.translation - low.translation) / (2 * step)
        jacobian[3:, index] = (high.rotation * low.rotation.inv()).as_rotvec() / (2 * step)
    both = np.zeros((12, 12))
    both[:6, :6], both[6:, 6:] = fits[0].covariance, fits[1].covariance
    return np.asarray(jacobian @ both @ jacobian.T)


def _residuals(first: AxisFit, second: AxisFit) -> dict[str, float]:
    return {
        f"{axis} {name}": float(np.linalg.norm(residual))
        for axis, fit in (("A1", first), ("A2", second))
        for name, residual in zip(fit.residual_names, fit.residuals_m, strict=True)
    }


def _checks(
    c_T_base: UncertainPose,
    first: AxisFit,
    second: AxisFit,
    *,
    a1_error_m: float,
    squareness_rad: float,
    limits: BaseFrameLimits,
) -> Checks:
    sigma = c_T_base.sigma
    degrees = np.degrees
    arc_deg = float(degrees(min(first.arc_rad, second.arc_rad)))
    return (
        LimitCheck("A1 residual rms", first.rms_m / MM, limits.rms_m / MM, "mm"),
        LimitCheck("A2 residual rms", second.rms_m / MM, limits.rms_m / MM, "mm"),
        # The data sheet is an independent witness: exchanged axes, a wrong sign or a wrong link
        # show here.
        LimitCheck("a1 against D-H", abs(a1_error_m) / MM, limits.a1_error_m / MM, "mm"),
        LimitCheck(
            "squareness of A1 and A2",
            float(degrees(abs(squareness_rad))),
            float(degrees(limits.squareness_rad)),
            "°",
        ),
        LimitCheck("position sigma", sigma[:3].max() / MM, limits.position_sigma_m / MM, "mm"),
        LimitCheck(
            "rotation sigma",
            float(degrees(sigma[3:].max())),
            float(degrees(limits.rotation_sigma_rad)),
            "°",
        ),
        LimitCheck("smaller arc", arc_deg, float(degrees(limits.arc_rad)), "°", "min"),
    )


def _warnings(name: str, fit: AxisFit) -> tuple[str, ...]:
    warnings = []
    if fit.arc_rad < ADVISED_ARC_RAD - 1e-6:
        warnings.append(f"{name} turned by {np.degrees(fit.arc_rad):.0f}° only; 90° are advised")
    if len(fit.targets) < 2:
        warnings.append(f"{name} was seen with a single target; six are advised")
    # Squares: beyond twice the stated noise.
    if fit.chi2_ratio > 4:
        warnings.append(f"{name} scatters {np.sqrt(fit.chi2_ratio):.1f} times the stated noise")
    return tuple(warnings)
