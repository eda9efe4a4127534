"""What lies between the encoder of a joint, which sits at the motor, and the joint itself."""

import math

import numpy as np

from fakes.scenario_file.sections import Chain
from fakes.world.frames import Array

CYCLES = 40.0
"""Periods of the transmission error in a turn of the joint: the pins of a cycloidal reducer."""


class Transmission:
    """How far each joint is from where its encoder says."""

    def __init__(
        self, rng: np.random.Generator, chain: Chain, *, ripple_rad: float, sag_rad: float
    ) -> None:
        """``ripple_rad``: amplitude of the transmission error. ``sag_rad``: what is left of the sag
        of the second joint while the arm is stretched out level."""
        self._phase = rng.uniform(0, 2 * np.pi, 6)
        self._ripple = ripple_rad
        # Shared between upper arm and forearm by their lengths, so that both together are
        # ``sag_rad`` where the arm is stretched out.
        self._upper = sag_rad * chain.a2 / (chain.a2 + chain.d4)
        self._fore = sag_rad * chain.d4 / (chain.a2 + chain.d4)

    def error(self, joints_rad: Array) -> Array:
        """True minus shown angle of each joint, shape (6,)."""
        error = self._ripple * np.sin(CYCLES * joints_rad + self._phase)
        shoulder, elbow = float(joints_rad[1]), float(joints_rad[2])
        # Positive angles lower the arm, and so does gravity. What each of the two joints carries
        # grows with the level distance of the mass from it.
        fore = self._fore * math.cos(shoulder + elbow)
        error[1] += self._upper * math.cos(shoulder) + fore
        error[2] += fore
        return np.asarray(error)
