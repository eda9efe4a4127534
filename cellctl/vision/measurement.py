"""The result of measuring the holes in one stereo pair."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.ellipse import Ellipse

Method = Literal["default", "paper"]
Side = Literal["left", "right"]


@dataclass(frozen=True, slots=True, eq=False)
class HoleMeasurement:
    """One hole, measured by both cameras of a head."""

    name: str
    kind: str
    left_px: Array
    """Raw pixel, shape (2,): where the centre of the circle projects to. By the paper's method it
    is the centre of the ellipse, which lies beside that (eccentricity)."""
    right_px: Array
    left_covariance_px2: Array
    """Shape (2, 2)."""
    right_covariance_px2: Array
    position_m: Array
    """Shape (3,), in the left camera."""
    covariance_m2: Array
    """Shape (3, 3)."""
    left_ellipse: Ellipse
    right_ellipse: Ellipse
    diameter_m: float
    """Measured diameter, mean of both cameras."""
    epipolar_px: float
    """Distance of the right point from the epipolar line of the left one."""
    left_out: float = 0.0
    """Share of the rim that is off its circle, as by a dent or under a reflex, and has left the
    fit: that of the image in which it is greater."""


@dataclass(frozen=True, slots=True)
class PairMeasurement:
    """The holes of one stereo pair, or of several averaged ones."""

    method: Method
    holes: tuple[HoleMeasurement, ...]
    frames: int = 1

    @property
    def names(self) -> tuple[str, ...]:
        """Names in the order of ``holes``."""
        return tuple(hole.name for hole in self.holes)

    @property
    def positions_m(self) -> Array:
        """Shape (n, 3)."""
        return np.array([hole.position_m for hole in self.holes]).reshape(-1, 3)

    @property
    def covariances_m2(self) -> Array:
        """Shape (n, 3, 3)."""
        return np.array([hole.covariance_m2 for hole in self.holes]).reshape(-1, 3, 3)
