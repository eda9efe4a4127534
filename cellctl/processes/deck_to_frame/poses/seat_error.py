"""How far a seated deck is from its seat."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import MM, Array


@dataclass(frozen=True, slots=True, eq=False)
class SeatError:
    """A seated deck as the cameras saw it."""

    error: Array
    """Seat minus measured, shape (6,): x, y, z in m and rx, ry, rz in rad, in the axes of M."""
    offsets_mm: Mapping[str, float]
    """Lateral distance of each judged hole from its place, by the name of the hole."""

    @property
    def gap_mm(self) -> float:
        """Between deck and frame in the middle of the face; positive when the deck stands off."""
        return -float(self.error[2]) / MM

    @property
    def rotation_deg(self) -> float:
        """About the worst axis."""
        return float(np.degrees(np.abs(self.error[3:]).max()))
