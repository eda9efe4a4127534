"""How many terms the model of a lens has: OpenCV's, of which each contains the shorter ones."""

from enum import Enum

import numpy as np

from cellctl.geometry.pose import Array


class LensModel(Enum):
    """Terms of the distortion that are adjusted."""

    FIVE = "five"
    """k1, k2, p1, p2, k3: a polynomial of the radius, and a lens off its axis."""
    RATIONAL = "rational"
    """And k4 to k6: a polynomial over another, for wide lenses."""
    THIN_PRISM = "thin-prism"
    """And s1 to s4: elements that are tilted among each other."""
    TILTED = "tilted"
    """And the two angles by which the sensor is tilted to the lens."""

    @property
    def terms(self) -> int:
        """Length of the distortion."""
        return {"five": 5, "rational": 8, "thin-prism": 12, "tilted": 14}[self.value]


_SIGMA = np.array([2.0] * 3 + [0.2] * 4 + [0.2] * 2)
"""Priors of the terms beyond five. What the rational terms do, those of the polynomial nearly do
too, and without a prior both would grow without bounds against each other."""


def longer_terms_prior(terms: int) -> Array:
    """Inverse prior variances of a camera's numbers, shape (4 + terms,); 0 for the first nine."""
    return np.concatenate([np.zeros(9), 1 / _SIGMA[: terms - 5] ** 2])
