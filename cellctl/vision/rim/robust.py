"""Robust statistics of a few hundred values, without the overhead of the general ones."""

import numpy as np

from cellctl.geometry.pose import Array

_SIGMA_OVER_MEDIAN = 1.4826
"""Of absolute deviations that are normally distributed."""


def median(values: Array) -> float:
    """The upper median of values of shape (n,), n > 0."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


def robust_sigma(residuals: Array) -> float:
    """Standard deviation of residuals about zero, shape (n,), n > 0, unmoved by outliers."""
    return _SIGMA_OVER_MEDIAN * median(np.abs(residuals))
