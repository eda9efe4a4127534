"""Slow displacement of a body by warmth."""

import numpy as np

from fakes.world.frames import Array
from fakes.world.wander import small_displacement

_STEP_S = 10.0
_HOUR_S = 3600.0


class ThermalDrift:
    """An offset since the body was calibrated, and a steady drift in the direction of its own.

    The drift goes on in steps of ten seconds: pictures that are taken shortly after each other show
    the same scene then, which is rendered once.
    """

    def __init__(self, rng: np.random.Generator, size_m: float, lever_m: float) -> None:
        """``size_m``: largest offset along each axis, and largest drift in an hour. The rotation is
        that by which a point at a distance of ``lever_m`` moves by as much."""
        sizes = np.repeat([size_m, size_m / lever_m], 3)
        self._offset = rng.uniform(-1, 1, 6) * sizes
        self._rate_per_s = rng.uniform(-1, 1, 6) * sizes / _HOUR_S

    def at(self, time_s: float) -> Array:
        """Displacement at a time as a 4x4 matrix."""
        return small_displacement(self._offset + self._rate_per_s * (time_s // _STEP_S * _STEP_S))
