"""Gravity compensation of a six-axis sensor: what the hanging load contributes, and taking it off.

A wrench reads ``y = A u + b`` where ``u`` is the unit vector of gravity in sensor axes. The affine
form absorbs gain, cross-talk and mounting errors around the orientation it was identified at.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.geometry.pose import Array

GRAVITY_M_S2 = 9.80665
"""Standard gravity; a site may use its own value."""

BASE_DOWN: tuple[float, float, float] = (0.0, 0.0, -1.0)
"""Direction of gravity in a robot base that stands level, unit vector."""


@dataclass(frozen=True, slots=True)
class GravityCompensation:
    """The wrench of the unmoving load as a function of the sensor's orientation."""

    A: Array
    """Shape (6, 3): N and N·m for a unit vector of gravity in sensor axes."""
    b: Array
    """Shape (6,): offset in N and N·m."""
    method: str
    """``affine24``, ``rigid12`` or ``none``."""
    residual_n: float = 0.0
    """Root mean square of the force residuals of the identification, a component."""
    residual_n_m: float = 0.0
    """The same for the torques."""
    base_down: tuple[float, float, float] = BASE_DOWN
    """Direction of gravity in the base that the fit used, unit vector."""

    def __post_init__(self) -> None:
        if self.A.shape != (6, 3) or self.b.shape != (6,):
            raise ValueError(f"A is (6, 3) and b (6,), got {self.A.shape} and {self.b.shape}")

    @classmethod
    def none(cls) -> Self:
        """Takes nothing off: enough below a tare while the orientation does not change."""
        return cls(np.zeros((6, 3)), np.zeros(6), "none")

    def load(self, base_R_sensor: Rotation) -> Array:
        """Wrench of the load at one orientation, shape (6,), or at n, shape (n, 6)."""
        return gravity_in_sensor(base_R_sensor, self.base_down) @ self.A.T + self.b

    def apply(self, wrench: Array, base_R_sensor: Rotation) -> Array:
        """Contact wrench in sensor axes, shape (6,) or (n, 6): reading less load."""
        return np.asarray(wrench - self.load(base_R_sensor))


def gravity_in_sensor(
    base_R_sensor: Rotation, base_down: tuple[float, float, float] = BASE_DOWN
) -> Array:
    """Unit vector of gravity in sensor axes, shape (3,) for one rotation, (n, 3) for n."""
    return np.asarray(base_R_sensor.inv().apply(base_down), dtype=float)
