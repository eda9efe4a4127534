"""What a pair of connectors does in contact: sizes and forces, drawn for each pair."""

from dataclasses import dataclass
from math import atan, tan

import numpy as np

from fakes.world.connector.drawing import ConnectorDrawing
from fakes.world.frames import Array

_PEAK_N = (0.4, 2.4)
"""Least and highest spring force of a contact over all lots. Published are 0.36 to 2.38 N to mate a
contact of connectors to MIL-DTL-55302G, at 25.4 mm/min: series differ by 6 : 1."""
_PEAK_SPREAD = 0.25
"""Half width of the relative difference between the contacts of a lot; assumed."""
_TURNING_M2 = 2.5e-4
"""Stiffness of the turn about the axis over the lateral one: springs at 16 mm from the axis."""


@dataclass(frozen=True, slots=True)
class MatingSizes:
    """Geometry and stiffness that all contacts of a pair share; all assumed, to be measured."""

    clear_m: float = 0.03e-3
    """Radial play of a pin in its bore."""
    capture_m: float = 0.20e-3
    """Radial offset at the face up to which the funnel takes a pin."""
    funnel_m: float = 0.25e-3
    """Depth of the funnel."""
    wall_n_m: float = 2e5
    """Stiffness of one pin against the wall of its hole: the pin bends."""
    friction: float = 0.2
    face_n_m: float = 1.5e5
    """Stiffness of one pin that stands on the face."""
    collapse_n: float = 25.0
    """Axial force at which a standing pin gives way for good."""
    spring_begin_m: float = 0.5e-3
    """Depth at which a pin begins to open its contact spring."""
    spring_rise_m: float = 0.4e-3
    """Way over which the spring's force rises to its peak, and falls again by as long a way."""
    sliding_share: float = 0.7
    """Share of the peak that is left once the contact spring has opened."""
    seat_m: float = 2.5e-3
    """Depth at which the shells meet."""
    seat_n_m: float = 5e5
    """Stiffness of shell on shell."""

    @classmethod
    def of(cls, drawing: ConnectorDrawing) -> "MatingSizes":
        """Sizes as the drawing has them."""
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
        """Stiffness along x, along y and about the axis, in N/m and N·m/rad."""
        return np.array([self.lateral_n_m, self.lateral_n_m, self.lateral_n_m * _TURNING_M2])


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
