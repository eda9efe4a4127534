"""What a pair of connectors does in contact: sizes and forces, drawn for each pair."""

from dataclasses import dataclass
from math import atan, tan

import numpy as np

from fakes.world.connector.drawing import ConnectorDrawing
from fakes.world.frames import Array

_PEAK_N = (0.4, 2.4)
"""Least and highest spring force of a contact over all lots; published figures differ by 6 : 1."""
_PEAK_SPREAD = 0.25


@dataclass(frozen=True, slots=True)
class MatingSizes:
    """Geometry and stiffness that all contacts of a pair share; all assumed, to be measured."""

    clear_m: float = 0.03e-3
    capture_m: float = 0.20e-3
    funnel_m: float = 0.25e-3
    wall_n_m: float = 2e5
    """Of one pin against the wall of its hole: the pin bends."""
    friction: float = 0.2
    face_n_m: float = 1.5e5
    """Of one pin that stands on the face."""
    collapse_n: float = 25.0
    spring_begin_m: float = 0.5e-3
    spring_rise_m: float = 0.4e-3
    sliding_share: float = 0.7
    """Of the peak, once the contact spring has opened."""
    seat_m: float = 2.5e-3
    seat_n_m: float = 5e5

    @classmethod
    def of(cls, drawing: ConnectorDrawing) -> "MatingSizes":
        """As drawn."""
        return cls(
            drawing.bore_play_m,
            drawing.capture_m,
            drawing.funnel_m,
            spring_begin_m=drawing.spring_begin_m,
            seat_m=drawing.seat_m,
        )

    @property
    def funnel_slope(self) -> float:
        """Axial over radial force on the flat of the funnel, while the pin goes in.

        The wall's normal stands at the angle of the funnel, friction turns it by its own.
        """
        angle = atan((self.capture_m - self.clear_m) / self.funnel_m)
        return tan(angle + atan(self.friction))

    def play(self, depth_m: Array) -> Array:
        """Radial play of each pin at its depth."""
        left = np.maximum(1 - depth_m / self.funnel_m, 0.0)
        return np.asarray(self.clear_m + (self.capture_m - self.clear_m) * left)


@dataclass(frozen=True, slots=True)
class Mount:
    """Springs behind the plug: gripper, compliance and arm."""

    lateral_n_m: float = 5e4
    axial_n_m: float = 5e5

    @property
    def stiffness(self) -> Array:
        """Of x, y and the turn about the axis, N/m and N·m/rad."""
        return np.array([self.lateral_n_m, self.lateral_n_m, self.lateral_n_m * 2.5e-4])


@dataclass(frozen=True, slots=True, eq=False)
class MatingPair:
    """Plug and socket; places in the frame of the socket, z out of its face."""

    sizes: MatingSizes
    pins_m: Array
    """Tips with their bends where they are when the plug is in its nominal place, shape (n, 2)."""
    holes_m: Array
    """Shape (n, 2)."""
    peaks_n: Array
    """Highest force of each contact spring, shape (n,)."""
    present: Array
    """1 for a pin that is there, shape (n,)."""
    blocked: Array
    """1 for a hole that takes no pin, shape (n,)."""


def draw_peaks(rng: np.random.Generator, contacts: int) -> Array:
    """Spring forces of one lot: log-uniform, with a spread from contact to contact."""
    lot_n = float(np.exp(rng.uniform(*np.log(_PEAK_N))))
    return lot_n * rng.uniform(1 - _PEAK_SPREAD, 1 + _PEAK_SPREAD, contacts)
