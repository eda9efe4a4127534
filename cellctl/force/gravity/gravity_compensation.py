"""Gravity compensation of a six-axis sensor: subtract the weight of the load that hangs on it.

At rest a sensor reads ``y = A u + b``, where ``u`` is the unit vector of gravity in sensor axes. A
rigid load on an ideal sensor would need four numbers (mass and centre of mass) beside the offset;
this affine form has eighteen and so absorbs gain, cross-talk and mounting errors of the sensor
around the orientation it was identified at.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skew

GRAVITY_M_S2 = 9.80665
"""Standard gravity; a site may use its own value."""

BASE_DOWN: tuple[float, float, float] = (0.0, 0.0, -1.0)
"""Direction of gravity in a robot base that stands level, unit vector."""


@dataclass(frozen=True, slots=True, eq=False)
class GravityCompensation:
    """The wrench of the load at rest as a function of the sensor's orientation."""

    A: Array
    """Shape (6, 3): N and N·m for a unit vector of gravity in sensor axes."""
    b: Array
    """Shape (6,): offset in N and N·m."""
    method: str
    """``affine24``, ``rigid12`` or ``none``."""
    residual_n: float = 0.0
    """Root mean square over the force components of the residuals of the identification."""
    residual_n_m: float = 0.0
    """Root mean square over the torque components of the residuals."""
    base_down: tuple[float, float, float] = BASE_DOWN
    """Unit vector of gravity in the robot base, as the fit assumed it."""

    def __post_init__(self) -> None:
        if self.A.shape != (6, 3) or self.b.shape != (6,):
            raise ValueError(f"A is (6, 3) and b (6,), got {self.A.shape} and {self.b.shape}")

    @classmethod
    def none(cls) -> Self:
        """Subtract nothing: enough when a tare follows and the orientation does not change."""
        return cls(np.zeros((6, 3)), np.zeros(6), "none")

    @classmethod
    def rigid(cls, mass_kg: float, centre_of_mass_m: Array) -> Self:
        """A load (kg) with its centre of mass (3,) in the sensor frame, on an ideal sensor.

        From a drawing and not from an identification, so that a tare has to take the offset.
        """
        weight_n = mass_kg * GRAVITY_M_S2
        return cls(
            np.vstack([np.eye(3), skew(centre_of_mass_m)]) * weight_n, np.zeros(6), "rigid12"
        )

    def load(self, base_R_sensor: Rotation) -> Array:
        """Wrench of the load at one orientation, shape (6,), or at n, shape (n, 6)."""
        return gravity_in_sensor(base_R_sensor, self.base_down) @ self.A.T + self.b

    def apply(self, wrench: Array, base_R_sensor: Rotation) -> Array:
        """Contact wrench in sensor axes, shape (6,) or (n, 6): the reading less the load."""
        return np.asarray(wrench - self.load(base_R_sensor))


def gravity_in_sensor(
    base_R_sensor: Rotation, base_down: tuple[float, float, float] = BASE_DOWN
) -> Array:
    """Unit vector of gravity in sensor axes, shape (3,) for one rotation, (n, 3) for n."""
    return np.asarray(base_R_sensor.inv().apply(base_down), dtype=float)
