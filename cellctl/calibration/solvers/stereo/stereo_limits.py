"""What a calibration of a head must reach, from what its geometry allows.

A corner that is off by a tenth of a pixel is seen at a depth that is off by Z²/(f·B) of it. For the
head of the paper at 500 mm that is 0.05 mm, for a head of another size far less or more, so a limit
in millimetres would fit one head only.
"""

from dataclasses import dataclass, field

import numpy as np

from cellctl.calibration.checks import LimitCheck
from cellctl.calibration.solvers.coverage import CoverageLimits
from cellctl.calibration.solvers.view_rejection import MAX_REJECTED_RATIO
from cellctl.geometry.pose import MM, Array
from cellctl.vision.camera.stereo_head import StereoHead

_CORNER_PX = 0.1
"""Error of one coordinate of a corner that a usable calibration may have."""
_BASELINE_RATIO = 3e-4
"""Largest standard deviation of the baseline over it: 0.05 mm of the paper's 180 mm."""
_KNOWN_RATIO = 0.05
"""Lens and mount keep what their drawings say this well; a board that is taken for another, or
squares counted for millimetres, is further off."""


@dataclass(frozen=True, slots=True)
class KnownGeometry:
    """What is known of a head without a board. The images alone cannot tell the board's scale."""

    baseline_m: float | None = None
    distance_m: float | None = None
    """Median distance from the left camera to the board."""
    focal_px: float | None = None
    """Focal length over the size of a pixel, from the data sheets of lens and camera."""

    @property
    def tells_scale(self) -> bool:
        """Whether a wrong size of the squares would be noticed."""
        return self.baseline_m is not None or self.distance_m is not None

    def checks(self, head: StereoHead, distances_m: Array) -> list[LimitCheck]:
        """How far the result is from what is known."""
        focal_px = float(np.mean([np.diag(c.camera_matrix)[:2] for c in (head.left, head.right)]))
        found = (
            ("baseline", float(np.linalg.norm(head.translation_m)), self.baseline_m),
            ("distance of the board", float(np.median(distances_m)), self.distance_m),
            ("focal length", focal_px, self.focal_px),
        )
        return [
            LimitCheck(f"{name} against the stated one", abs(value / known - 1), _KNOWN_RATIO, "")
            for name, value, known in found
            if known is not None
        ]


@dataclass(frozen=True, slots=True)
class StereoLimits:
    """Limits of the result. Pixel figures count both axes of a corner, as OpenCV does."""

    coverage: CoverageLimits = field(default_factory=CoverageLimits)
    rms_px: float = 0.25
    rejected_ratio: float = MAX_REJECTED_RATIO
    held_out_m: float | None = None
    """Largest error of corners that were held out; None for what the geometry of the head
    allows."""
    baseline_sigma_m: float | None = None
    """Largest standard deviation of the baseline; None for a share of the baseline."""
    known: KnownGeometry = field(default_factory=KnownGeometry)

    def held_out_limit_m(self, head: StereoHead, distances_m: Array) -> float:
        """Error of corners that the calibration has not seen, measured in space."""
        if self.held_out_m is not None:
            return self.held_out_m
        focal_px = float(head.left.camera_matrix[0, 0])
        depth_m = float(np.median(distances_m)) ** 2 / (focal_px * _baseline_m(head))
        return float(np.sqrt(2) * _CORNER_PX * depth_m)

    def checks(
        self, head: StereoHead, distances_m: Array, rejected_ratio: float, held_out_m: float | None
    ) -> tuple[LimitCheck, ...]:
        """The figures of a result; ``distances_m`` of the boards, shape (views,)."""
        baseline_m = _baseline_m(head)
        direction = head.translation_m / baseline_m
        count = len(head.parameter_order)
        covariance = np.zeros((count, count)) if head.covariance is None else head.covariance
        sigma_m = float(np.sqrt(direction @ covariance[-3:, -3:] @ direction))
        limit_m = self.baseline_sigma_m or _BASELINE_RATIO * baseline_m
        checks = [
            LimitCheck("reprojection rms", head.rms_px, self.rms_px, "px"),
            LimitCheck("baseline sigma", sigma_m / MM, limit_m / MM, "mm"),
            LimitCheck("rejected views", rejected_ratio, self.rejected_ratio, ""),
        ]
        if held_out_m is not None:
            limit_m = self.held_out_limit_m(head, distances_m)
            checks.append(LimitCheck("held-out error", held_out_m / MM, limit_m / MM, "mm"))
        return (*checks, *self.known.checks(head, distances_m))


def _baseline_m(head: StereoHead) -> float:
    return float(np.linalg.norm(head.translation_m))
