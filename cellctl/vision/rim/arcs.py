"""Arcs of a rim that are not where the circle is: dents, burrs and reflexes lose their weight.

A single pixel tells little of its arc, so weights for single pixels leave an arc whose edge lies
elsewhere about its share of the influence. The pixels of an arc together tell how far its edge is
off, and with what certainty.
"""

import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.vision.rim.noise import median, robust_sigma

ARCS = 36
"""Arcs round a rim."""
_BIWEIGHT = 4.7
"""Arcs farther off than so many of their standard deviations count for nothing (Tukey): on a
perfect rim the others then lose 5 % of their efficiency."""
_LEAST_INFORMATION = 1e-3
"""Of the typical arc's: below it an arc says nothing of its place."""


def arcs_of(offsets: Array) -> NDArray[np.intp]:
    """Arc of each pixel, shape (n,), by its ``offsets`` (2, n) from the centre."""
    turns = np.arctan2(offsets[1], offsets[0]) / (2.0 * np.pi) + 0.5
    return np.asarray((turns * ARCS).astype(np.intp) % ARCS)


def arc_shares(arc: NDArray[np.intp], by_radius: Array, sigma: Array, residuals: Array) -> Array:
    """What is left of each pixel's weight, 0 to 1, shape (n,).

    ``by_radius`` (n,) is the derivative of each pixel's grey by the radius, the same as by a
    displacement of its arc alone; ``sigma`` (n,) is that of its error.
    """
    # All pixels of an arc count in full: that they are outliers is what must be seen here.
    slope = by_radius / sigma
    information: Array = np.bincount(arc, slope**2, ARCS).astype(float)
    moved: Array = np.bincount(arc, slope * residuals / sigma, ARCS).astype(float)
    seen = information > _LEAST_INFORMATION * median(information)
    if np.count_nonzero(seen) < ARCS // 2:
        return np.ones_like(sigma)
    off = np.where(seen, moved / np.maximum(information, 1e-300), 0.0)
    # Bad arcs have pulled the radius, and the others are all off by as much.
    off -= median(off[seen])
    sigmas = np.where(seen, off * np.sqrt(information), 0.0)
    # Where the whole rim is rough or its light is not quite that of the model, an arc is judged by
    # the others.
    scale = max(robust_sigma(sigmas[seen]), 1.0)
    left = np.maximum(1.0 - (sigmas / (_BIWEIGHT * scale)) ** 2, 0.0) ** 2
    return np.asarray(left[arc])
