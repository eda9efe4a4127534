"""A robust circle through edges, with a weak prior on its radius, and its covariance.

Light from one side, a chamfer or dirt moves part of the edges. They lose their influence by Tukey's
biweight; the prior keeps a rim of which one half is lost from growing towards that side.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.vision.contact_fit.rim_edges import DIRECTIONS, UNIT, RimEdges

_ROUNDS = 12
"""Most rounds of re-weighting."""
_TUKEY = 4.7
"""Residual in standard deviations from which an edge does not count at all; the usual figure, which
costs 5 % of the information where all errors are normal."""
_SIGMA_OVER_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their absolute values."""
_LEAST_PX = 0.06
"""Residuals are not expected to be smaller than this: on a perfect rim chance would decide which
edges are left."""
_INDEPENDENT_PX = 1.7
"""Distance along the rim at which the errors of two edges are independent: they share pixels."""
_FEWEST = 12
"""Least number of edges of a circle, out of 96 directions."""


@dataclass(frozen=True, slots=True, eq=False)
class Circle:
    """A rim in its plane."""

    centre_m: Array
    radius_m: float
    covariance_m2: Array
    """Covariance of the centre, shape (2, 2)."""
    support: float
    """Share of all directions with an edge on the circle."""
    scatter_m: float
    """Standard deviation of the edges from the circle."""
    slope_grey: float
    """Median strength of the edges, grey levels in a pixel."""


def fit_circle(
    edges: RimEdges, start_m: Array, radius_m: float, *, radius_sigma_m: float, px_m: float
) -> Circle | None:
    """The circle that most edges agree with; None with too few of them.

    ``radius_m`` and ``radius_sigma_m`` are the prior; ``px_m`` is the size of a pixel.
    """
    if len(edges.points_m) < _FEWEST:
        return None
    centre = np.array(start_m, dtype=float)
    scatter = 0.5 * px_m
    # From the middle of the edges opposite each other: a start that is off by some pixels would
    # have half of the rim taken for outliers.
    centre = centre + _opposite_middle(edges, centre)
    radius = float(np.median(np.linalg.norm(edges.points_m - centre, axis=1)))
    # Least squares that are weighted anew in each round, with Tukey's biweight, for centre and
    # radius. The prior of the radius is one more observation.
    normal = np.eye(3)
    weight = np.ones(len(edges.points_m))
    for _ in range(_ROUNDS):
        offset = edges.points_m - centre
        length = np.linalg.norm(offset, axis=1)
        rest = length - radius
        scatter = _scatter(rest, weight, px_m)
        weight = np.maximum(1.0 - (rest / (_TUKEY * scatter)) ** 2, 0.0) ** 2
        if np.count_nonzero(weight) < _FEWEST:
            return None
        design = np.column_stack([offset / length[:, None], np.ones(len(length))])
        weighted = design * (weight / scatter**2)[:, None]
        normal = weighted.T @ design
        right = weighted.T @ rest
        normal[2, 2] += 1.0 / radius_sigma_m**2
        right[2] += (radius_m - radius) / radius_sigma_m**2
        step = np.linalg.solve(normal, right)
        centre, radius = centre + step[:2], radius + float(step[2])
        if np.abs(step).max() < 1e-5 * px_m:
            break
    near = np.abs(np.linalg.norm(edges.points_m - centre, axis=1) - radius) < max(
        3.0 * scatter, 0.5 * px_m
    )
    # Edges closer than that share their pixels' noise and tell nothing new.
    spacing_px = 2.0 * np.pi * radius / px_m / DIRECTIONS
    shared = max(_INDEPENDENT_PX / spacing_px, 1.0)
    return Circle(
        centre_m=centre,
        radius_m=radius,
        covariance_m2=np.asarray(np.linalg.inv(normal)[:2, :2] * shared, dtype=float),
        support=float(np.count_nonzero(near)) / DIRECTIONS,
        scatter_m=scatter,
        slope_grey=float(np.median(edges.slope_grey)),
    )


def _opposite_middle(edges: RimEdges, centre: Array) -> Array:
    """Median offset of the middles of opposite edges along their rays, as a vector."""
    radius = np.full(DIRECTIONS, np.nan)
    radius[edges.direction] = np.linalg.norm(edges.points_m - centre, axis=1)
    half = DIRECTIONS // 2
    along = 0.5 * (radius[:half] - radius[half:])
    known = np.isfinite(along)
    if np.count_nonzero(known) < 6:
        return np.zeros(2)
    # Offsets along the rays determine the vector by least squares, in two rounds without the worst.
    directions, along = UNIT[:half][known], along[known]
    vector = np.linalg.lstsq(directions, along, rcond=None)[0]
    rest = np.abs(along - directions @ vector)
    close = rest <= max(float(np.quantile(rest, 0.7)), 1e-12)
    return np.asarray(np.linalg.lstsq(directions[close], along[close], rcond=None)[0])


def _scatter(rest: Array, weight: Array, px_m: float) -> float:
    """Robust standard deviation of the residuals that still count."""
    counted = rest[weight > 0]
    middle = np.median(counted)
    return max(_SIGMA_OVER_MEDIAN * float(np.median(np.abs(counted - middle))), _LEAST_PX * px_m)
