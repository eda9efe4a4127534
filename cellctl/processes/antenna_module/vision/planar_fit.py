"""x, y and yaw of a drawing in its plane from measured points, robust against single bent contacts.

Every point weighs by its image covariance plus the true position of a good contact. The fit is
Huber's; points farther off than ``REJECT`` standard deviations are then left out one by one, the
worst first, because a bent contact moves the fit and makes good ones look bad.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.vision.matching import rigid, rotation

REJECT = 6.0
"""Residual in standard deviations beyond which a point is left out: it is bent or not this
contact."""
_HUBER = 3.5
"""Residual, in standard deviations of a point with two coordinates, beyond which a point weighs
less: one good contact in 500."""
_ROUNDS = 8
"""Rounds of re-weighting."""
_FEWEST = 3
"""Two points give place and turn; the third says whether they fit."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanarFit:
    """``plane = rotation(yaw) @ drawing + shift``."""

    yaw_rad: float
    shift_m: Array
    covariance: Array
    """Covariance of x, y (m) and yaw (rad) by the image alone, shape (3, 3); the point is the
    drawing's origin."""
    residuals_m: Array
    """Measured less fitted, in the axes of the drawing, shape (n, 2); NaN where not measured."""
    used: NDArray[np.bool_]
    """Points that the fit rests on, shape (n,)."""
    scale: float
    """Scale of the drawing, left free as a check."""
    scale_sigma: float
    chi2: float
    freedom: int


@dataclass(frozen=True, slots=True, eq=False)
class _Data:
    drawing: Array
    points: Array
    image: Array
    """Covariances of the points by the image, shape (n, 2, 2)."""
    total: Array
    """The same with the true position."""


def fit_planar(
    drawing_m: Array, points_m: Array, covariances_m2: Array, true_position_m: float
) -> PlanarFit | None:
    """Fit n points (NaN where not measured), covariances (n, 2, 2); None with fewer than three."""
    used: NDArray[np.bool_] = np.asarray(np.isfinite(points_m).all(axis=1))
    total = covariances_m2 + true_position_m**2 * np.eye(2)
    data = _Data(drawing_m, points_m, covariances_m2, total)
    while np.count_nonzero(used) >= _FEWEST:
        yaw, shift, weights = _huber(drawing_m[used], points_m[used], total[used])
        rest = points_m - drawing_m @ rotation(yaw).T - shift
        # How far a point is off, in its own standard deviations.
        with np.errstate(invalid="ignore"):
            off = np.sqrt(np.einsum("ni,nij,nj->n", rest, np.linalg.inv(total), rest))
        worst = int(np.argmax(np.where(used, off, -1.0)))
        if off[worst] <= REJECT:
            return _result(data, used, yaw, shift, weights)
        used = used.copy()
        used[worst] = False
    return None


def _huber(drawing: Array, points: Array, total: Array) -> tuple[float, Array, Array]:
    """Yaw, shift and the weight matrices (n, 2, 2) of the last round."""
    yaw, shift = rigid(drawing, points)
    inverse = np.linalg.inv(total)
    weights = inverse
    for _ in range(_ROUNDS):
        design = _design(drawing, yaw)
        rest = points - drawing @ rotation(yaw).T - shift
        off = np.sqrt(np.einsum("ni,nij,nj->n", rest, inverse, rest))
        weights = inverse * np.minimum(1.0, _HUBER / np.maximum(off, 1e-12))[:, None, None]
        weighted = np.einsum("nij,njk->nik", weights, design)
        normal = np.einsum("nij,nik->jk", design, weighted)
        step = np.linalg.solve(normal, np.einsum("nij,ni->j", weighted, rest))
        shift, yaw = shift + step[:2], yaw + float(step[2])
    return yaw, shift, np.asarray(weights, dtype=float)


def _design(drawing: Array, yaw: float) -> Array:
    """Derivative of the placed points by x, y, yaw, shape (n, 2, 3)."""
    turned = drawing @ rotation(yaw).T
    design = np.zeros((len(drawing), 2, 3))
    design[:, 0, 0] = design[:, 1, 1] = 1.0
    design[:, 0, 2], design[:, 1, 2] = -turned[:, 1], turned[:, 0]
    return design


def _result(
    data: _Data, used: NDArray[np.bool_], yaw: float, shift: Array, weights: Array
) -> PlanarFit:
    drawing, points, image, total = data.drawing, data.points, data.image, data.total
    design = _design(drawing[used], yaw)
    weighted = np.einsum("nij,njk->nik", weights, design)
    normal = np.einsum("nij,nik->jk", design, weighted)
    # The weights hold the true position, the covariance does not: the best fit of the contacts as
    # they are is what mates, and true position does not make the image worse.
    spread = np.einsum("nij,nil,nlk->jk", weighted, image[used], weighted)
    inverse = np.linalg.inv(normal)
    rest = points - drawing @ rotation(yaw).T - shift
    chi2 = float(np.einsum("ni,nij,nj->", rest[used], np.linalg.inv(total[used]), rest[used]))
    scale, scale_sigma = _scale(drawing[used], points[used], total[used], yaw)
    return PlanarFit(
        yaw_rad=float((yaw + np.pi) % (2.0 * np.pi) - np.pi),
        shift_m=shift,
        covariance=inverse @ spread @ inverse,
        residuals_m=rest @ rotation(yaw),
        used=used,
        scale=scale,
        scale_sigma=scale_sigma,
        chi2=chi2,
        freedom=2 * int(np.count_nonzero(used)) - 3,
    )


def _scale(drawing: Array, points: Array, total: Array, yaw: float) -> tuple[float, float]:
    """Size of the pattern relative to its drawing, and its standard deviation."""
    arms = drawing - drawing.mean(axis=0)
    seen = (points - points.mean(axis=0)) @ rotation(yaw)
    square = float((arms**2).sum())
    variance = float(np.einsum("ni,nij,nj->", arms, total, arms)) / square**2
    return float((arms * seen).sum()) / square, float(np.sqrt(variance))
