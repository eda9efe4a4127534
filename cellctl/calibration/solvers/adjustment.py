"""Weighted least squares with the covariance of the solution."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cellctl.errors.calibration import IllConditioned, SolveFailed
from cellctl.geometry.pose import Array

_MAX_CONDITION = 1e12
"""Largest condition of the scaled Jacobian. Beyond it no digit of the covariance is right."""


@dataclass(frozen=True, slots=True, eq=False)
class Adjustment:
    """Minimum of the sum of squares of residuals that are in units of their sigma."""

    parameters: Array
    covariance: Array
    """Inverse normal matrix, grown by ``chi2_ratio`` where that is above 1."""
    chi2_ratio: float
    """Weighted squares over the degrees of freedom: 1 when the stated noise is right."""


def weighted_least_squares(residuals: Callable[[Array], Array], start: Array) -> Adjustment:
    """Minimise; raises ``SolveFailed`` or ``IllConditioned``."""
    # Loaded by whoever solves, which in the daemon are its workers.
    from scipy.optimize import least_squares

    # Central differences: the covariance comes from this Jacobian, so its accuracy counts.
    result = least_squares(residuals, start, jac="3-point", x_scale="jac", xtol=1e-13, ftol=1e-13)
    if not result.success:
        raise SolveFailed(str(result.message))
    jacobian = np.asarray(result.jac, dtype=float)
    # Columns of one length: metres beside radians must not look like an ill-conditioned problem.
    scale = np.linalg.norm(jacobian, axis=0)
    if not scale.all() or np.linalg.cond(jacobian / scale) > _MAX_CONDITION:
        raise IllConditioned("some unknown has no influence on the data")
    scaled = jacobian / scale
    covariance = np.linalg.inv(scaled.T @ scaled) / np.outer(scale, scale)
    # At least one: with as many unknowns as data the residuals say nothing about the noise.
    freedom = max(len(jacobian) - len(start), 1)
    chi2_ratio = float(2 * result.cost / freedom)
    # Residuals that scatter less than stated may be luck, so the covariance never shrinks.
    return Adjustment(np.asarray(result.x), covariance * max(1.0, chi2_ratio), chi2_ratio)
