"""The result of the calibration of one camera."""

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
from cellctl.geometry.pose import Array
from cellctl.vision.camera.single_camera import (
    SingleCamera,
    single_camera_from_json,
    single_camera_to_json,
)


@dataclass(frozen=True, slots=True)
class CameraViewResidual:
    """Rms residual of one image, both axes together."""

    name: str
    rms_px: float
    corners: int
    used: bool
    """False for a view that was left out; its residual is that of its board at its best pose."""
    shift_sigmas: float | None = None
    """How much the unknowns of the camera move without this view: root mean square, in stated
    standard deviations. None for a view that was left out, and in records of older versions."""


@dataclass(frozen=True, slots=True, eq=False)
class SingleCameraResult:
    """A calibrated camera and how far to trust it."""

    camera: SingleCamera
    method: str
    board: CalibrationBoard
    views: tuple[CameraViewResidual, ...]
    board_m: Array
    """Corners of the board as found, shape (n, 3)."""
    coverage: Coverage
    sigma: Array
    """Standard deviations of the camera's ``CAMERA_PARAMETERS``, shape (4 + terms,)."""
    rms_px: float
    """Residual of the corners of all views that were used, both axes together."""
    held_out_px: float | None
    """Residual of views that the calibration has not seen; None with too few views."""
    sigma_px: float
    """Standard deviation of a corner coordinate."""
    checks: Checks
    warnings: tuple[str, ...]
    found_shape: FoundShape | None = None
    """What was released of the board's shape; None in records of older versions."""
    residuals: Array = field(default_factory=lambda: np.zeros((0, 4)))
    """Columns u, v, du, dv in px; for the picture only, not in the record."""

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    @property
    def flatness_m(self) -> float:
        """Height of the board from its lowest to its highest corner."""
        return float(np.ptp(self.board_m[:, 2]))

    def to_record(self) -> dict[str, Any]:
        """Plain data: the camera's file with the evidence added."""
        return {
            **single_camera_to_json(self.camera),
            **evidence_to_record(self.method, self.checks, self.warnings),
            "sigma": self.sigma.tolist(),
            "rms_px": self.rms_px,
            "held_out_px": self.held_out_px,
            "sigma_px": self.sigma_px,
            "board": board_to_record(self.board),
            **corners_to_record(self.board_m),
            **found_shape_to_record(self.found_shape),
            "views": [
                {name: getattr(view, name) for name in CameraViewResidual.__slots__}
                for view in self.views
            ],
            "coverage": coverage_to_record(self.coverage),
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "SingleCameraResult":
        """The inverse of ``to_record``; raises ``KeyError``, ``TypeError`` or ``ValueError``."""
        held_out_px = record["held_out_px"]
        return cls(
            camera=single_camera_from_json(record),
            method=str(record["method"]),
            board=board_from_record(record["board"]),
            views=tuple(CameraViewResidual(**view) for view in record["views"]),
            board_m=corners_from_record(record),
            found_shape=found_shape_from_record(record),
            coverage=coverage_from_record(record["coverage"]),
            sigma=np.asarray(record["sigma"], dtype=float),
            rms_px=float(record["rms_px"]),
            held_out_px=None if held_out_px is None else float(held_out_px),
            sigma_px=float(record["sigma_px"]),
            checks=checks_from_record(record["checks"]),
            warnings=tuple(record["warnings"]),
        )
