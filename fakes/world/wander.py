"""The repeatability error of an arm as a smooth random function of its travel."""

import numpy as np

from fakes.world.frames import Array

_WAVES = 24
"""Enough for a normal distribution: over 3000 arms the fourth moment is 2.93 and not 3, and the
correlation keeps within 0.02 of the exponential."""
_SHORTEST_M = 2e-3
"""Shortest wave of the error along the way. The spectrum has no end of its own, and shorter waves
would act like noise of single reports."""


class Wander:
    """Six components, stationary, with correlation near exp(-travel / length).

    A sum of cosines over the travel with frequencies drawn from the spectrum of that correlation:
    a small step changes the error little, a long way gives a new one, and the same travel gives the
    same error whatever the times of the queries.
    """

    def __init__(self, rng: np.random.Generator, sigma: Array, correlation_m: float) -> None:
        # The spectrum of exp(-x / length) is the distribution of Cauchy, whose quantiles are
        # tangents; it is cut off at the shortest wave.
        cut = np.arctan(2 * np.pi / _SHORTEST_M * correlation_m)
        self._rate_per_m = np.tan(rng.uniform(-cut, cut, (6, _WAVES))) / correlation_m
        self._phase = rng.uniform(0, 2 * np.pi, (6, _WAVES))
        self._amplitude = sigma * np.sqrt(2 / _WAVES)

    def error(self, travel_m: float) -> Array:
        """x, y, z (m) and rotation vector (rad) in flange axes."""
        waves = np.cos(self._rate_per_m * travel_m + self._phase).sum(axis=1)
        return np.asarray(self._amplitude * waves)


def small_displacement(error: Array) -> Array:
    """x, y, z (m) and rotation vector (rad), well below a milliradian, as a 4x4 matrix."""
    x, y, z, rx, ry, rz = error.tolist()
    return np.array([[1, -rz, ry, x], [rz, 1, -rx, y], [-ry, rx, 1, z], [0, 0, 0, 1.0]])
