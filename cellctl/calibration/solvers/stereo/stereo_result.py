"""The result of a stereo calibration."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.board_record import (
    board_from_record,
    board_to_record,
    corners_from_record,
    corners_to_record,
)
from cellctl.calibration.boards.known_board import (
    FoundShape,
    found_shape_from_record,
    found_shape_to_record,
)
from cellctl.calibration.checks import (
    Checks,
    all_passed,
    checks_from_record,
    evidence_to_record,
)
from cellctl.calibration.solvers.coverage import (
    Coverage,
    coverage_from_record,
    coverage_to_record,
)
from cellctl.calibration.solvers.stereo.stereo_validation import CrossValidation
from cellctl.geometry.pose import MM, Array
from cellctl.vision.camera.stereo_head import (
    StereoHead,
    stereo_head_from_json,
    stereo_head_to_json,
)


@dataclass(frozen=True, slots=True)
class ViewResidual:
    """Rms residual of one pair, both axes together."""

    name: str
    left_rms_px: float
    right_rms_px: float
    left_corners: int
    right_corners: int
    used: bool
    """False for a view that was left out; its residuals are those of its board at its best pose."""
    shift_sigmas: float | None = None
    """How much the unknowns of the head move without this view: root mean square, in stated
    standard deviations. None for a view that was left out, and in records of older versions."""


def _no_residuals() -> Array:
    return np.zeros((0, 4))


@dataclass(frozen=True, slots=True, eq=False)
class StereoResult:
    """A calibrated head and how far to trust it."""

    head: StereoHead
    method: str
    board: CalibrationBoard
    views: tuple[ViewResidual, ...]
    board_m: Array
    """Corners of the board as found, shape (n, 3)."""
    coverage: tuple[Coverage, Coverage]
    """Left, right."""
    validation: CrossValidation | None
    checks: Checks
    warnings: tuple[str, ...]
    sigma_px: float
    """Standard deviation of a corner coordinate."""
    found_shape: FoundShape | None = None
    """What was released of the board's shape; None in records of older versions."""
    left_residuals: Array = field(default_factory=_no_residuals)
    """Columns u, v, du, dv in px; for the picture only, not in the record."""
    right_residuals: Array = field(default_factory=_no_residuals)

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    @property
    def held_out_m(self) -> float | None:
        """Error of corners that the calibration has not seen; None with too few views."""
        return None if self.validation is None else self.validation.held_out_m

    @property
    def flatness_m(self) -> float:
        """Height of the board from its lowest to its highest corner."""
        return float(np.ptp(self.board_m[:, 2]))

    def to_record(self) -> dict[str, Any]:
        """Plain data: the head's file with the evidence added."""
        return {
            **stereo_head_to_json(self.head),
            **evidence_to_record(self.method, self.checks, self.warnings),
            "sigma_px": self.sigma_px,
            "board": board_to_record(self.board),
            **corners_to_record(self.board_m),
            **found_shape_to_record(self.found_shape),
            "views": [_view_to_record(view) for view in self.views],
            "coverage": [coverage_to_record(side) for side in self.coverage],
            "cross_validation": _validation_to_record(self.validation),
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "StereoResult":
        """The inverse of ``to_record``; raises ``KeyError``, ``TypeError`` or ``ValueError``."""
        left, right = (coverage_from_record(side) for side in record["coverage"])
        return cls(
            head=stereo_head_from_json(record),
            method=str(record["method"]),
            board=board_from_record(record["board"]),
            views=tuple(ViewResidual(**view) for view in record["views"]),
            board_m=corners_from_record(record),
            found_shape=found_shape_from_record(record),
            coverage=(left, right),
            validation=_validation_from_record(record["cross_validation"]),
            checks=checks_from_record(record["checks"]),
            warnings=tuple(record["warnings"]),
            sigma_px=float(record["sigma_px"]),
        )


def _view_to_record(view: ViewResidual) -> dict[str, Any]:
    return {name: getattr(view, name) for name in ViewResidual.__slots__}


def _validation_to_record(validation: CrossValidation | None) -> dict[str, float] | None:
    if validation is None:
        return None
    return {
        "held_out_mm": validation.held_out_m / MM,
        "difference_mm": validation.difference_m / MM,
        "difference_deg": float(np.degrees(validation.difference_rotation_rad)),
    }


def _validation_from_record(record: Mapping[str, float] | None) -> CrossValidation | None:
    if record is None:
        return None
    turn_rad = float(np.radians(record["difference_deg"]))
    return CrossValidation(record["held_out_mm"] * MM, record["difference_mm"] * MM, turn_rad)
