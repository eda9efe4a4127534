"""Figures of the metrology benchmark: errors against truth, bounds and stated uncertainties."""

from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from cellctl.geometry.pose import pose_error
from cellctl.vision.measurement import HoleMeasurement
from cellctl.vision.registration.part_pose import PartPose
from tests.rigs.metrology.views import NOISE_GREY, HeadView, PartView

Array = NDArray[np.float64]


def crlb_px(radius_px: float, contrast_grey: float, noise_grey: float, blur_px: float) -> float:
    """Cramér–Rao bound of a centre coordinate: blurred dark disc, white noise, 8 bit rounding.

    std ≥ (σ / A) sqrt(2 σe / (sqrt(π) r)) with σe² = blur² + 1/12 and σ² = noise² + 1/12.
    """
    edge = np.sqrt(blur_px**2 + 1.0 / 12.0)
    noise = np.sqrt(noise_grey**2 + 1.0 / 12.0)
    return float(noise / contrast_grey * np.sqrt(2.0 * edge / (np.sqrt(np.pi) * radius_px)))


@dataclass
class HoleErrors:
    """Errors of the holes of one kind, all images together."""

    along_px: list[Array] = field(default_factory=list)
    """Both coordinates of each image point's error."""
    bounds_px: list[float] = field(default_factory=list)
    squared_2d: list[float] = field(default_factory=list)
    """Normalised error squared of image points, two degrees of freedom."""
    squared_3d: list[float] = field(default_factory=list)
    depth_m: list[float] = field(default_factory=list)
    size_ratios: list[float] = field(default_factory=list)
    """Measured over nominal diameters."""

    def add(self, view: HeadView, hole: HoleMeasurement, step_grey: float) -> None:
        """Take in one hole; ``step_grey`` is the typical difference of grey across its rim."""
        truth_m = view.truth_m[hole.name]
        focal_px = float(view.head.left.camera_matrix[0, 0])
        radius_px = focal_px * hole.diameter_m / 2.0 / truth_m[2]
        bound_px = crlb_px(radius_px, step_grey, NOISE_GREY, view.blur_px)
        error_m = hole.position_m - truth_m
        self.squared_3d.append(_squared(error_m, hole.covariance_m2))
        self.depth_m.append(float(error_m[2]))
        nominal_m = next(one.diameter_m for one in view.holes if one.name == hole.name)
        self.size_ratios.append(hole.diameter_m / nominal_m)
        left_px, right_px = view.truth_px[hole.name]
        for error_px, covariance_px2 in (
            (hole.left_px - left_px, hole.left_covariance_px2),
            (hole.right_px - right_px, hole.right_covariance_px2),
        ):
            self.along_px.append(error_px)
            self.bounds_px.append(bound_px)
            self.squared_2d.append(_squared(error_px, covariance_px2))

    def take(self, other: "HoleErrors") -> None:
        """Take in all errors of another one."""
        for one in fields(self):
            getattr(self, one.name).extend(getattr(other, one.name))

    @property
    def count(self) -> int:
        return len(self.along_px)

    @property
    def norms_px(self) -> Array:
        return np.asarray(np.linalg.norm(self.along_px, axis=1))

    def median_ratio(self) -> float:
        """Median error over the median that the bound allows for two coordinates."""
        return float(np.median(self.norms_px / np.array(self.bounds_px)) / np.sqrt(2 * np.log(2)))

    def p95_px(self) -> float:
        return float(np.quantile(self.norms_px, 0.95))

    def worst_px(self) -> float:
        return float(self.norms_px.max())

    def diameter_bias_permille(self) -> float:
        return (float(np.mean(self.size_ratios)) - 1.0) * 1e3

    def depth_bias_um(self) -> float:
        return float(np.mean(self.depth_m)) * 1e6


@dataclass
class PoseErrors:
    """Errors of registered parts."""

    translation_m: list[Array] = field(default_factory=list)
    rotation_rad: list[Array] = field(default_factory=list)
    squared: list[float] = field(default_factory=list)

    def add(self, part: PartView, result: PartPose) -> None:
        """Take in one pose; errors in the axes of the part."""
        truth = part.views[0].camera_T_part
        translation_m, rotation_rad = pose_error(truth, result.pose.pose)
        error = np.concatenate([translation_m, rotation_rad])
        self.squared.append(_squared(error, result.pose.covariance))
        turn = truth.rotation.inv()
        middle_m = result.pose.pose.translation - truth.translation
        self.translation_m.append(turn.apply(middle_m))
        self.rotation_rad.append(turn.apply(rotation_rad))

    def position_um(self) -> Array:
        """Rms by axis at the part's origin, the middle between the heads."""
        return np.asarray(np.sqrt(np.mean(np.square(self.translation_m), axis=0)) * 1e6)

    def rotation_deg(self) -> Array:
        """Rms by axis."""
        return np.asarray(np.degrees(np.sqrt(np.mean(np.square(self.rotation_rad), axis=0))))


def _squared(error: Array, covariance: Array) -> float:
    """Normalised error squared."""
    return float(error @ np.linalg.solve(covariance, error))


def band(freedom: int, count: int) -> tuple[float, float]:
    """95 % band of the mean of ``count`` normalised errors squared."""
    total = freedom * count
    return float(chi2.ppf(0.025, total)) / count, float(chi2.ppf(0.975, total)) / count
