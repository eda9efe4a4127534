"""Arcs of a rim that are off its circle: dents, nicks and wear, and what a reflex hides of an edge.

To a fit they are noise that all pixels of an arc share: there the edge stands beside the circle, by
an amount that the residuals show. What is alike all round says how worn the rim is, and widens the
covariance; an arc that stands out from the others leaves the fit, unless the others are no circle.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from cellctl.geometry.pose import Array
from cellctl.vision.rim.noise import PixelNoise, less_outliers, median, robust_sigma

ARCS = 36
"""Of 10° each: at a rim of 20 px three pixels long, about as long as an edge is blurred."""
MODEL_PX = 0.01
"""How far arcs of a whole rim may be off its circle because the model of light and blur is not
quite what is seen. In images without noise it is 0.002 to 0.007 px in most (robust standard
deviation, medians of thirteen drawn looks), 0.014 px at most. It counts beside the noise."""
_FAR, _BESIDE_FAR = 3.0, 1.5
"""Standard deviations from which on an arc stands out: alone, and beside one that does."""
_ALIKE = 0.5
"""Mean product of what neighbouring arcs are off, over the variance of one by its pixels, from
which on they are alike. By chance it stays below 0.4, as it does beside most dents."""
_RAGGED = 3.0
"""Times the squares of the residuals of most arcs, from which on an arc looks like something else
than a rim, wherever its edge is."""
_CLIP_SIGMAS = 10.0
"""Residuals are clipped here for that: one bright pixel is no arc."""
_LEFT_OUT = 1e-4
"""Weight that is left to the pixels of an arc that has left the fit."""
_LEAST_WEAR = 0.3
"""Share of the noise of one arc below which wear of a rim is not worth the work."""
_FAINT = 1e-3
"""Arcs that tell less than this share of what the best one tells show no edge."""

_TRIALS = 60
"""Random triples of arcs. With three quarters of them on the circle four triples in ten are
clean."""
_LEAST_SPREAD = 0.5
"""Least determinant of such a triple: arcs close together say little of a centre."""
_REFINEMENTS = 3

_ANGLES: Array = (np.arange(ARCS, dtype=float) + 0.5) * (2.0 * np.pi / ARCS) - np.pi
_DESIGN: Array = np.column_stack([np.ones(ARCS), np.cos(_ANGLES), np.sin(_ANGLES)])
"""How far an arc moves out when radius, x and y of the circle change."""


def arc_of(azimuth: Array) -> NDArray[np.intp]:
    """The arc in which each pixel lies, by its direction from the centre in rad, shape (n,)."""
    return np.asarray(((azimuth + np.pi) / (2.0 * np.pi) * ARCS).astype(int) % ARCS)


def with_arcs(noise: PixelNoise, residuals: Array, by_radius: Array, azimuth: Array) -> PixelNoise:
    """The noise of the pixels (n,) with that of the arcs.

    ``by_radius`` is the derivative of the grey values by the radius in px, ``azimuth`` the
    direction from the centre in which each pixel lies, rad.
    """
    arc = arc_of(azimuth)
    shown, variance, seen = _shown(arc, noise, residuals, by_radius)
    off = _off_circle(shown, variance, seen)
    worn = max(robust_sigma(off[seen]) ** 2 - median(variance[seen]), 0.0)
    sigmas = np.abs(off) / np.sqrt(max(worn, MODEL_PX**2) + variance)
    far = (sigmas > _FAR) | _ragged(residuals - by_radius * shown[arc], noise.variance, arc)
    far |= (np.roll(far, 1) | np.roll(far, -1)) & (sigmas > _BESIDE_FAR)
    shared = csr_array((by_radius * np.sqrt(worn), (arc, np.arange(len(arc)))), (ARCS, len(arc)))
    shared = shared[np.flatnonzero(worn > _LEAST_WEAR**2 * variance)]
    kept = less_outliers(residuals, noise.variance, csr_array(vstack([noise.strokes, shared])))
    left_out = far[arc]
    less = np.where(left_out, _LEFT_OUT, 1.0)
    return replace(PixelNoise.of(kept.weights * less, kept.strokes), left_out=left_out)


def rest_waves(noise: PixelNoise, residuals: Array, by_radius: Array, azimuth: Array) -> bool:
    """Whether neighbours among the arcs that stay in a finished fit are off its circle alike.

    Such a rim has no circle of which a dent takes a part: its flanks and crests go over into each
    other, and which of them look like one is chance. Arguments as of ``with_arcs``, whose noise it
    is.
    """
    arc = arc_of(azimuth)
    off, variance, seen = _shown(arc, noise, residuals, by_radius)
    stay = seen & (np.bincount(arc, noise.left_out, minlength=ARCS) == 0)
    pairs = stay & np.roll(stay, 1)
    alike = off * np.roll(off, 1) / (variance + MODEL_PX**2)
    return bool(pairs.any()) and float(np.mean(alike[pairs])) > _ALIKE


def _shown(
    arc: NDArray[np.intp], noise: PixelNoise, residuals: Array, by_radius: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """How far each arc is off by its residuals, its variance by its pixels, and whether it shows an
    edge, each of shape (36,)."""
    weights = 1.0 / noise.variance
    size = np.bincount(arc, by_radius * by_radius * weights, minlength=ARCS)
    pull = np.bincount(arc, by_radius * residuals * weights, minlength=ARCS)
    least = _FAINT * size.max()
    variance = 1.0 / np.maximum(size, least)
    return pull * variance, variance, np.asarray(size > least)


def _ragged(residuals: Array, variance: Array, arc: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Which arcs look like something else, shape (36,)."""
    squares = np.minimum(residuals**2 / variance, _CLIP_SIGMAS**2)
    count = np.maximum(np.bincount(arc, minlength=ARCS), 1)
    mean = np.bincount(arc, squares, minlength=ARCS) / count
    return np.asarray(mean > _RAGGED * max(float(np.median(mean)), 1.0))


def _off_circle(off: Array, variance: Array, seen: NDArray[np.bool_]) -> Array:
    """How far arcs lie off the circle that most of them agree on, shape (36,).

    Least median of squares, then Tukey's biweight.
    """
    # The seed makes the same image give the same result.
    order = np.tile(np.flatnonzero(seen), (_TRIALS, 1))
    picks = np.random.default_rng(ARCS).permuted(order, axis=1)[:, :3]
    picks = picks[np.abs(np.linalg.det(_DESIGN[picks])) > _LEAST_SPREAD]
    circles = np.linalg.solve(_DESIGN[picks], off[picks][..., None])[..., 0]
    # The circle of the fit itself is one of the trials.
    rest = off - np.concatenate([circles, np.zeros((1, 3))]) @ _DESIGN.T
    best = rest[np.argmin(np.median(np.abs(rest[:, seen]), axis=1))]
    for _ in range(_REFINEMENTS):
        total = robust_sigma(best[seen]) ** 2 + variance
        closeness = np.maximum(1.0 - best**2 / (_FAR**2 * total), 0.0) ** 2
        weighted = _DESIGN * np.where(seen, closeness / total, 0.0)[:, None]
        normal = weighted.T @ _DESIGN
        normal += 1e-9 * np.trace(normal) * np.eye(3)
        best = off - _DESIGN @ np.linalg.solve(normal, weighted.T @ off)
    return np.asarray(best)
