"""Several measurements of an unmoved scene, combined into one."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cellctl.errors.vision import ResidualsTooLarge
from cellctl.geometry.pose import MM, Array
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement

_MAX_SCATTER_M = 0.1e-3
"""Frames of an unmoved scene scatter by some micrometres. What is off by this has moved."""
_SYSTEMATIC_SHARE = 0.65
"""Share of one frame's standard deviation that more frames do not average away: the texture of the
rim and the errors of the light model are the same in every frame. Measured on rendered machined
parts."""


def average(measurements: Sequence[PairMeasurement]) -> PairMeasurement:
    """Mean of measurements of the same holes from an unmoved head and part.

    Raises ``ResidualsTooLarge`` when a hole moved between frames, ``ValueError`` for an empty or
    mixed list.
    """
    if not measurements:
        raise ValueError("nothing to average")
    names, method = measurements[0].names, measurements[0].method
    if any(item.names != names or item.method != method for item in measurements):
        raise ValueError("measurements of different holes or methods cannot be averaged")
    frames = sum(item.frames for item in measurements)
    # A single measurement stays as it is, also when it is an average itself.
    if len(measurements) == 1:
        return measurements[0]
    columns = zip(*(item.holes for item in measurements), strict=True)
    return PairMeasurement(method, tuple(_mean_hole(column) for column in columns), frames)


def _mean_hole(column: tuple[HoleMeasurement, ...]) -> HoleMeasurement:
    position_m, covariance_m2 = _mean(
        [item.position_m for item in column], [item.covariance_m2 for item in column]
    )
    # An average over a part that moved would be precise and wrong.
    scatter_m = max(float(np.linalg.norm(item.position_m - position_m)) for item in column)
    if scatter_m > _MAX_SCATTER_M:
        raise ResidualsTooLarge(f"{column[0].name} moved by {scatter_m / MM:.3f} mm between frames")
    left_px, left_covariance = _mean(
        [item.left_px for item in column], [item.left_covariance_px2 for item in column]
    )
    right_px, right_covariance = _mean(
        [item.right_px for item in column], [item.right_covariance_px2 for item in column]
    )
    return replace(
        column[0],
        left_px=left_px,
        right_px=right_px,
        left_covariance_px2=left_covariance,
        right_covariance_px2=right_covariance,
        position_m=position_m,
        covariance_m2=covariance_m2,
        diameter_m=float(np.mean([item.diameter_m for item in column])),
        epipolar_px=float(np.mean([item.epipolar_px for item in column])),
        left_out=max(item.left_out for item in column),
    )


def remaining_variance(frames: int) -> float:
    """Share of one frame's variance that stays in the mean of so many frames of one scene."""
    share = _SYSTEMATIC_SHARE**2
    return share + (1.0 - share) / frames


def _mean(values: Sequence[Array], covariances: Sequence[Array]) -> tuple[Array, Array]:
    """Mean, and its covariance: the random part shrinks with the frames, the common one stays."""
    typical = np.mean(covariances, axis=0)
    return np.mean(values, axis=0), np.asarray(typical * remaining_variance(len(values)))
