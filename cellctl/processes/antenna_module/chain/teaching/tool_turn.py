"""Where a feature on the gripper lies beside the flange axis, by turning it before camera II.

Only the scale of camera II enters: ``seen_k = centre + R(±angle_k) · offset``, linear in both.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.checks import (
    Checks,
    LimitCheck,
    all_passed,
    checks_from_record,
    evidence_to_record,
)
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.faults.calibration import TurnInvalid

_WIDEST_GAP_RAD = float(np.radians(180))
"""Largest gap between neighbouring angles: with all of them on one side of the turn its centre and
the offset are known only together."""


@dataclass(frozen=True, slots=True, eq=False)
class TurnStop:
    """One angle of the last joint, and where the feature was seen."""

    angle_rad: float
    seen_m: Array
    """x and y in the plane of the feature, in the axes of the camera, shape (2,)."""


@dataclass(frozen=True, slots=True, eq=False)
class ToolTurnResult:
    """The flange axis in the camera, and the feature beside it."""

    axis_m: Array
    """Where the axis meets the plane, in the axes of the camera, shape (2,)."""
    offset_m: Array
    """From the axis to the feature at angle 0, in the axes of the camera, shape (2,)."""
    sigma_m: float
    """Standard deviation of either, per axis, from the residuals."""
    residual_rms_m: float
    """Per axis."""
    stops: int
    checks: Checks
    residuals_m: Array
    """Seen less fitted, in the axes of the camera, shape (stops, 2); not in the record."""
    seen_m: Array
    """Where the feature was seen, shape (stops, 2); for the picture, not in the record."""

    method = "circle about the flange axis"

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def to_record(self) -> dict[str, Any]:
        """Plain data: mm."""
        return {
            **evidence_to_record(self.method, self.checks),
            "axis_mm": (self.axis_m / MM).tolist(),
            "offset_mm": (self.offset_m / MM).tolist(),
            "sigma_mm": self.sigma_m / MM,
            "residual_rms_mm": self.residual_rms_m / MM,
            "stops": self.stops,
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "ToolTurnResult":
        """The inverse of ``to_record``; raises ``ValueError`` for places that are none."""
        axis, offset = (np.array(record[f"{name}_mm"], dtype=float) for name in ("axis", "offset"))
        if axis.shape != (2,) or offset.shape != (2,):
            raise ValueError("axis and offset have x and y each")
        return cls(
            axis_m=axis * MM,
            offset_m=offset * MM,
            sigma_m=float(record["sigma_mm"]) * MM,
            residual_rms_m=float(record["residual_rms_mm"]) * MM,
            stops=int(record["stops"]),
            checks=checks_from_record(record["checks"]),
            residuals_m=np.zeros((0, 2)),
            seen_m=np.zeros((0, 2)),
        )


def calibrate_tool_turn(
    stops: Sequence[TurnStop], *, residual_limit_m: float = 30e-6, sigma_limit_m: float = 20e-6
) -> ToolTurnResult:
    """Solve for axis and offset.

    Raises ``TurnInvalid`` with fewer than three angles, with angles that lie within half a turn,
    or when the points lie on no circle that turns with the joint.
    """
    if len(stops) < 3:
        raise TurnInvalid(f"{len(stops)} angles, at least 3 needed")
    angles = np.array([stop.angle_rad for stop in stops])
    gap = _largest_gap(angles)
    if gap > _WIDEST_GAP_RAD + 1e-6:
        raise TurnInvalid(f"angles leave a gap of {np.degrees(gap):.0f}°, allowed 180°")
    seen = np.array([stop.seen_m for stop in stops])
    # A camera that looks against the axis sees the joint turn the other way.
    best, worse = sorted(
        (_fit(sign * angles, seen) for sign in (1.0, -1.0)), key=lambda fit: fit[2]
    )
    axis, offset, rms, residuals = best
    radius = float(np.linalg.norm(offset))
    if rms > residual_limit_m and rms > 0.1 * radius:
        raise TurnInvalid(
            f"residual {rms * 1e6:.0f} µm at a radius of {radius / MM:.3f} mm; "
            f"turning the other way {worse[2] * 1e6:.0f} µm"
        )
    sigma = rms / float(np.sqrt(len(stops)))
    checks = (
        LimitCheck("angles", len(stops), 4, "", "min"),
        LimitCheck("residual rms", rms / MM, residual_limit_m / MM, "mm"),
        LimitCheck("sigma of the offset", sigma / MM, sigma_limit_m / MM, "mm"),
    )
    return ToolTurnResult(axis, offset, sigma, rms, len(stops), checks, residuals, seen)


def _largest_gap(angles: Array) -> float:
    around = np.sort(np.mod(angles, 2 * np.pi))
    return float(np.diff(np.append(around, around[0] + 2 * np.pi)).max())


def _fit(angles: Array, seen: Array) -> tuple[Array, Array, float, Array]:
    """Centre, offset, residual rms per axis, residuals of shape (n, 2)."""
    cosines, sines = np.cos(angles), np.sin(angles)
    ones, zeros = np.ones_like(angles), np.zeros_like(angles)
    of_x = np.column_stack([ones, zeros, cosines, -sines])
    of_y = np.column_stack([zeros, ones, sines, cosines])
    matrix, known = np.concatenate([of_x, of_y]), np.concatenate([seen[:, 0], seen[:, 1]])
    solution = np.linalg.lstsq(matrix, known, rcond=None)[0]
    residuals = known - matrix @ solution
    # Four unknowns: x and y of the axis, and of the offset.
    spare = max(1, len(known) - 4)
    rms = float(np.sqrt(residuals @ residuals / spare))
    return solution[:2], solution[2:], rms, np.asarray(residuals.reshape(2, -1).T)
