"""Data and result of a hand-eye calibration."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import (
    Checks,
    all_passed,
    checks_from_record,
    evidence_to_record,
)
from cellctl.calibration.pose_record import pose_from_record, pose_to_record
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose


class Setup(Enum):
    """Where the camera is mounted."""

    EYE_IN_HAND = "eye-in-hand"
    EYE_TO_HAND = "eye-to-hand"

    @property
    def other(self) -> "Setup":
        """The setup that one may have meant instead."""
        return Setup.EYE_TO_HAND if self is Setup.EYE_IN_HAND else Setup.EYE_IN_HAND

    def turn(self, base_T_flange: RigidTransform) -> RigidTransform:
        """The pose of the arm with which turn · X · camera_T_board = Z."""
        return base_T_flange if self is Setup.EYE_IN_HAND else base_T_flange.inv()


@dataclass(frozen=True, slots=True)
class HandEyePose:
    """The readings of robot and camera at one stop."""

    name: str
    base_T_flange: RigidTransform
    camera_T_board: UncertainPose


@dataclass(frozen=True, slots=True)
class RobotNoise:
    """Standard deviations of the reported flange pose, per axis."""

    position_m: float = 5e-5
    rotation_rad: float = float(np.radians(0.005))

    @property
    def covariance(self) -> Array:
        """Shape (6, 6)."""
        return np.diag([self.position_m**2] * 3 + [self.rotation_rad**2] * 3)


@dataclass(frozen=True, slots=True)
class HandEyeResult:
    """Camera and board on the two sides of the robot."""

    setup: Setup
    camera: UncertainPose
    """X: flange_T_camera (eye in hand) or base_T_camera (eye to hand)."""
    board: UncertainPose
    """Z: base_T_board (eye in hand) or flange_T_board (eye to hand)."""
    residuals: Mapping[str, tuple[float, float]]
    """Per pose: distance (m) and angle (rad) of the board from where X and Z put it."""
    rejected: tuple[str, ...]
    """Poses left out as gross errors; their residuals are listed too."""
    chi2_ratio: float
    """Weighted squares over their expectation: 1 when the stated noise is right."""
    spread_rad: tuple[float, float, float]
    """Turns of the flange, rms along their principal directions."""
    checks: Checks
    warnings: tuple[str, ...]
    method: str = "closed form (Park), then maximum likelihood with robot and camera covariance"
    camera_id: str | None = None
    """Identity of the intrinsics that the poses of the board were measured with; None where it is
    not known. The result holds for these alone: it has absorbed their errors."""

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def to_record(self) -> dict[str, Any]:
        """Plain data for the store."""
        camera, board = _NAMES[self.setup]
        return {
            **evidence_to_record(self.method, self.checks, self.warnings),
            "setup": self.setup.value,
            camera: pose_to_record(self.camera),
            board: pose_to_record(self.board),
            "residuals_mm_deg": {
                name: [distance_m / MM, float(np.degrees(angle_rad))]
                for name, (distance_m, angle_rad) in self.residuals.items()
            },
            "rejected": list(self.rejected),
            "chi2_ratio": self.chi2_ratio,
            "spread_deg": np.degrees(self.spread_rad).tolist(),
            **({} if self.camera_id is None else {"camera_id": self.camera_id}),
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "HandEyeResult":
        """The inverse of ``to_record``."""
        setup = Setup(record["setup"])
        camera, board = _NAMES[setup]
        first, second, third = (float(value) for value in np.radians(record["spread_deg"]))
        return cls(
            setup=setup,
            camera=pose_from_record(record[camera]),
            board=pose_from_record(record[board]),
            residuals={
                name: (distance_mm * MM, float(np.radians(angle_deg)))
                for name, (distance_mm, angle_deg) in record["residuals_mm_deg"].items()
            },
            rejected=tuple(record["rejected"]),
            chi2_ratio=float(record["chi2_ratio"]),
            spread_rad=(first, second, third),
            checks=checks_from_record(record["checks"]),
            warnings=tuple(record["warnings"]),
            method=str(record["method"]),
            camera_id=record.get("camera_id"),
        )


_NAMES = {
    Setup.EYE_IN_HAND: ("flange_T_camera", "base_T_board"),
    Setup.EYE_TO_HAND: ("base_T_camera", "flange_T_board"),
}
