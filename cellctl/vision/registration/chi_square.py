"""Whether the uncertainties of measured points explain what a registration leaves of them."""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from cellctl.geometry.pose import Array

_CHANCE = 0.01
"""Probability with which points whose uncertainties are right fail the test."""


@dataclass(frozen=True, slots=True)
class ChiSquare:
    """Residuals against their expected size."""

    chi2: float
    """Normalised residuals squared; ``freedom`` is expected."""
    freedom: int
    """Degrees of freedom: coordinates less the six of the pose."""

    @property
    def limit(self) -> float:
        """Greatest chi square that chance explains."""
        return float(chdtri(self.freedom, _CHANCE))

    @property
    def explained(self) -> bool:
        """True when the stated uncertainties explain the residuals."""
        return self.chi2 <= self.limit

    @property
    def growth(self) -> float:
        """Factor by which the variance of the pose must grow; 1 where chance explains it."""
        return 1.0 if self.explained else self.chi2 / self.freedom


def chi_square(residuals_m: Array, covariance_m2: Array, design: Array, gain: Array) -> ChiSquare:
    """Chi square of n points registered by ``gain``.

    ``residuals_m`` (n, 3); ``covariance_m2`` of all coordinates (3n, 3n), errors that points share
    included; ``design`` (3n, 6), derivative of the points by the pose; ``gain`` (6, 3n), the
    opposite.
    """
    freedom = covariance_m2.shape[0] - 6
    left = np.eye(covariance_m2.shape[0]) - design @ gain
    # The pose has absorbed six combinations of the errors. The covariance of the residuals is
    # therefore singular in six directions, those of the smallest eigenvalues: they are left out.
    values, vectors = np.linalg.eigh(left @ covariance_m2 @ left.T)
    along = residuals_m.ravel() @ vectors[:, -freedom:]
    return ChiSquare(float(np.sum(along**2 / values[-freedom:])), freedom)
