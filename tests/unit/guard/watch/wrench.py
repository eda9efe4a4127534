"""Wrenches on arrays: the guard's plain floats are tested against them."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class Wrench:
    """Force (N) and torque (N·m) about the origin of the frame that both are expressed in.

    Sign: what the surroundings and gravity exert on the tool side of the sensor. A deck that is
    pushed up by the frame has a positive force along z of the deck.
    """

    force_n: Array
    torque_n_m: Array

    @classmethod
    def from_vector(cls, fx_to_mz: Array) -> "Wrench":
        """A wrench from a vector of shape (6,): Fx, Fy, Fz, Mx, My, Mz."""
        return cls(np.array(fx_to_mz[:3], dtype=float), np.array(fx_to_mz[3:], dtype=float))

    @property
    def vector(self) -> Array:
        """Fx, Fy, Fz, Mx, My, Mz."""
        return np.concatenate([self.force_n, self.torque_n_m])

    def in_frame(self, b_T_a: RigidTransform) -> "Wrench":
        """The same load, given in frame a, about the origin of b and in its axes."""
        force_n = b_T_a.rotation.apply(self.force_n)
        torque_n_m = b_T_a.rotation.apply(self.torque_n_m) + np.cross(b_T_a.translation, force_n)
        return Wrench(force_n, torque_n_m)
