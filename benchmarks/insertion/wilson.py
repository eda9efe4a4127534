"""Bounds of a success rate."""

from math import sqrt

_Z95 = 1.959964


def wilson_bounds(successes: int, trials: int) -> tuple[float, float]:
    """95 % score interval of Wilson; right also where all or none succeed.

    Source: E. B. Wilson, Journal of the American Statistical Association 22 (1927) 209.
    """
    rate, z2 = successes / trials, _Z95**2
    middle = (rate + z2 / (2 * trials)) / (1 + z2 / trials)
    half = _Z95 * sqrt(rate * (1 - rate) / trials + z2 / (4 * trials**2)) / (1 + z2 / trials)
    return max(0.0, middle - half), min(1.0, middle + half)
