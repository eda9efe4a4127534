"""How the light of a point spreads over an image, beside the blur that each rim tells by itself."""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtr

from cellctl.geometry.pose import Array

_SQRT_2PI = float(np.sqrt(2.0 * np.pi))


@dataclass(frozen=True, slots=True, eq=False)
class ImageSpread:
    """What all rims of one image share: it belongs to the exposure and to the lens."""

    movement_px: Array = field(default_factory=lambda: np.zeros(2))
    """How far the image has moved while it was exposed: standard deviation, along its way (2,), in
    pixels. It adds to the blur of edges that lie across that way."""
    excess: float = 0.0
    """Excess kurtosis of the spread across an edge: below 0 for a lens out of focus, -1 for an even
    disc."""

    @property
    def moved(self) -> bool:
        """Whether the blur depends on direction."""
        return bool(self.movement_px.any())


def outside_edge(z: Array, excess: float) -> Array:
    """Share of the light outside an edge, by the distance ``z`` from it over the blur.

    Gram-Charlier series of a normal distribution with an excess kurtosis, to its first term.
    """
    outside = ndtr(z)
    if excess:
        outside = outside - (excess / 24.0) * (z * z - 3.0) * z * _normal(z)
    return np.asarray(outside)


def edge_density(z: Array, excess: float) -> Array:
    """The derivative of ``outside_edge`` by ``z``."""
    density = _normal(z)
    if excess:
        squares = z * z
        density = density * (1.0 + (excess / 24.0) * (squares * (squares - 6.0) + 3.0))
    return density


def _normal(z: Array) -> Array:
    return np.asarray(np.exp(-0.5 * z * z) / _SQRT_2PI)
