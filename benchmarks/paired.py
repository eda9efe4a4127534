"""Two ways to do the same, tried with the same seeds."""

import numpy as np

from cellctl.geometry.pose import Array


def mean_difference(pairs: Array) -> tuple[float, float]:
    """Mean of the second less the first of each pair, and the standard deviation of that mean.

    ``pairs`` has the shape (n, 2), with n of 2 or more.
    """
    differences = pairs[:, 1] - pairs[:, 0]
    return float(differences.mean()), float(differences.std(ddof=1) / np.sqrt(len(differences)))
