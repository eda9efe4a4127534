"""The random numbers of one task."""

from math import exp, log

import numpy as np

_SLUGGISH_SHARE, _SLUGGISH = 0.1, 4.0
"""Cells that are told a dead time so many times as long; stiff ones refuse tight holes then."""


class Draws:
    """Draws of one task."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([seed, 91])
        drawn = np.random.default_rng([seed, 92]).random()
        self.sluggish = _SLUGGISH if drawn < _SLUGGISH_SHARE else 1.0

    def between(self, low: float, high: float) -> float:
        """Uniform."""
        return float(self.rng.uniform(low, high))

    def magnitude(self, low: float, high: float) -> float:
        """Uniform in its logarithm."""
        return exp(self.between(log(low), log(high)))

    def chance(self, share: float) -> bool:
        """True in so many of all draws."""
        return bool(self.rng.random() < share)
