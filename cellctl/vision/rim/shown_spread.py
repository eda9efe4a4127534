"""How an image has spread the light of a point, from all its rims together.

A movement of camera or part during the exposure blurs the edges that lie across the movement, and
leaves those along it sharp. A lens out of focus spreads a point over a disc. One rim shows this
only roughly, because light on its wall or chamfer that differs from side to side looks the same.
But the spread belongs to the exposure, so all rims of an image show the same one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.shape import across_rim
from cellctl.vision.rim.solver import RimFit
from cellctl.vision.rim.spread import ImageSpread

_LEAST_RIMS = 2
"""One rim alone cannot tell the spread of the image from its own peculiarities."""
_OWN: Array = np.array([0.03, 0.03, 0.1])
"""Standard deviation that light and shape of one rim add to its estimate: px², px², excess."""
_LEAST: Array = np.array([0.01, 0.01, 0.05])
"""Smallest change that is looked for: that of a way of 0.5 px."""
_SIGNIFICANT = 3.0
"""Standard deviations from which on a change is worth another fit of all rims."""
_EXCESS = (-1.0, 0.0)
"""Bounds of the excess kurtosis: from an even disc to a normal distribution. A sharp core in a halo
has 3 to 6, for which the first term of the series does not hold: centres would be reported as surer
than they are."""
_BLUR = 3
"""Index of the blur in ``RimShape.vector``."""
_RIDGE = 1e-9
"""Keeps the matrix invertible where a rim shows nothing of one of the three."""


@dataclass(frozen=True, slots=True, eq=False)
class ShownSpread:
    """What one rim shows of the spread beyond what its fit has modelled."""

    change: Array
    """(a, b, k): the variance of the blur across an edge at the angle φ in the image, from columns
    towards rows, is by a cos 2φ + b sin 2φ greater, px², and its excess kurtosis by k."""
    sigma: Array
    """Standard deviation of each, if nothing but noise disturbs the rim."""


def shown_spread(fit: RimFit) -> ShownSpread:
    """Estimate the spread to first order from the fit of one image.

    Shape and light are free to follow, so that only what they cannot explain counts.
    """
    solution, shape = fit.solution, fit.shapes[0]
    by_blur = solution.design[solution.lights + _BLUR]
    (x, y), z = across_rim(fit.problem.views[0].pixels, shape)
    # The derivatives of a grey value by the variance of the blur and by its excess follow from the
    # derivative by the blur itself. For edges just inside or outside of the rim they are about the
    # same.
    by_variance, by_excess = by_blur / (2.0 * shape.blur_px), by_blur * shape.blur_px / 24.0
    rows = np.stack(
        [by_variance * (x * x - y * y), by_variance * 2.0 * x * y, by_excess * (z * z - 3.0)]
    )
    normal, imitated, score = solution.further(rows)
    covariance = np.linalg.inv(normal - imitated + _RIDGE * np.eye(len(rows)))
    return ShownSpread(covariance @ score, np.sqrt(covariance.diagonal()))


def image_spread(before: ImageSpread, rims: Sequence[ShownSpread]) -> ImageSpread:
    """The spread of an image that these rims show together.

    ``before`` is the spread that their fits had modelled. The same object is returned where the
    rims show nothing beyond it.
    """
    if len(rims) < _LEAST_RIMS:
        return before
    weights = np.array([1.0 / (rim.sigma**2 + _OWN**2) for rim in rims])
    change = np.average([rim.change for rim in rims], axis=0, weights=weights)
    large = np.abs(change) > np.maximum(_SIGNIFICANT / np.sqrt(weights.sum(axis=0)), _LEAST)
    if not large.any():
        return before
    x, y = before.movement_px
    a, b = np.array([x * x - y * y, 2.0 * x * y]) / 2.0
    if large[:2].any():
        a, b = a + change[0], b + change[1]
    # A variance of M along a way at the angle θ is M/2 + M/2 cos 2(φ - θ) across an edge at φ.
    length_px, angle = float(np.sqrt(2.0 * np.hypot(a, b))), 0.5 * float(np.arctan2(b, a))
    excess = before.excess
    if large[2]:
        excess = float(np.clip(excess + change[2], *_EXCESS))
        if excess == before.excess and not large[:2].any():
            return before
    return ImageSpread(length_px * np.array([np.cos(angle), np.sin(angle)]), excess)
