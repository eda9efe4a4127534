"""How sure an adjustment is, from how much its views disagree.

Residuals of one view hang together: the board is bent a little otherwise than its model, an edge is
blurred in one direction, the lens is not quite the polynomial. The inverse of the normal matrix
takes every corner for a witness of its own and is too small then, on real images by a factor of
1.6 to 3.4 in standard deviations. What the views say *against each other* is the better witness.

Leave one view out, and the solution moves. The sum of the squares of these moves is the jackknife's
covariance (the cluster-robust estimator CR3: Bell and McCaffrey 2002, Survey Methodology 28(2)).
With as few views as unknowns it is rough, in some directions even zero, so it is shrunk towards a
multiple of the normal matrix's inverse as far as its own scatter asks for (Ledoit and Wolf 2004,
J. Multivariate Analysis 88, equations 9 to 14).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array

_LEAST_REST = 0.05
"""Share of the information in any direction that must be left without a view. A view that alone
determines an unknown would move it without bounds."""


@dataclass(frozen=True, slots=True, eq=False)
class WeighedViews:
    """What the views say of the shared unknowns."""

    covariance: Array
    """Covariance of the shared unknowns, shape (s, s)."""
    shift_sigmas: Array
    """Root mean square move of the unknowns without each view, in standard deviations of
    ``covariance``, shape (views,)."""


def weigh_views(prior: Array, information: Array, pulls: Array, name: str) -> WeighedViews:
    """Covariance of unknowns to which each view adds information.

    ``prior`` is the inverse prior variance of each unknown, shape (s,); ``information`` the normal
    matrix of each view, shape (v, s, s), in units of the residuals' noise; ``pulls`` its gradient
    at the solution, shape (v, s). Raises ``SolveFailed`` where something is undetermined.
    """
    total = np.diag(prior) + information.sum(axis=0)
    if not (np.diag(total) > 0).all():
        raise SolveFailed(f"the {name} adjustment is singular")
    # Unknowns of one size: pixels, metres and radians differ by six orders of magnitude.
    scale = 1 / np.sqrt(np.diag(total))
    try:
        factor = np.linalg.cholesky(total * np.outer(scale, scale))
    except np.linalg.LinAlgError as error:
        raise SolveFailed(f"the {name} adjustment is singular") from error
    # In these coordinates the inverse of the normal matrix is the unit matrix.
    white = solve_triangular(factor, np.diag(scale), lower=True)
    moves = np.stack(
        [
            _move(white @ own @ white.T, white @ pull)
            for own, pull in zip(information, pulls, strict=True)
        ]
    )
    # The jackknife's covariance is (v - 1) / v times the sum of the squared moves; ``_shrunk``
    # divides by v.
    spread = _shrunk(moves * np.sqrt(max(len(moves) - 1, 1)))
    # Views that agree better than their noise allows may do so by luck: never below the noise.
    values, vectors = np.linalg.eigh(spread)
    values = np.maximum(values, 1.0)
    back = white.T @ vectors
    shifts = np.sqrt(((moves @ vectors) ** 2 / values).mean(axis=1))
    return WeighedViews((back * values) @ back.T, shifts)


def _move(information: Array, pull: Array) -> Array:
    """How far the solution moves without a view, by one Newton step, shape (s,)."""
    # All pulls add up to nothing at the solution. Without this view -pull is left, and of the
    # information, which is the unit matrix in these coordinates, what the view does not give.
    values, vectors = np.linalg.eigh(information)
    rest = np.maximum(1 - values, _LEAST_REST)
    move: Array = -vectors @ ((vectors.T @ pull) / rest)
    return move


def _shrunk(samples: Array) -> Array:
    """Second moment of samples (n, s), shrunk towards a multiple of the unit matrix."""
    count, size = samples.shape
    spread = samples.T @ samples / count
    level = np.trace(spread) / size
    target = level * np.eye(size)
    distance = float(((spread - target) ** 2).sum())
    squares = (samples**2).sum(axis=1)
    # Sum over the samples of the squared distance between x x' and their mean.
    scatter = float((squares**2).sum()) / count**2 - float((spread**2).sum()) / count
    share = 1.0 if distance <= 0.0 else min(1.0, scatter / distance)
    return np.asarray(share * target + (1 - share) * spread)
