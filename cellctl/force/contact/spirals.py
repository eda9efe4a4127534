"""Ways of a search in the plane of a face: for the hole of a peg, and for the holes of pins."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_STEP_RAD = 0.15
"""Angle between two points of a turn: the straight lines between them lie within 0.3 % of the
radius inside the spiral, a few micrometres at 1 mm."""
_FASTEST_RAD_S = 2.0
"""Greatest rate at which the direction of the way turns: no turn takes less than three seconds,
however small it is."""


def expanding_turns(
    radius_m: float, pitch_m: float, speed_m_s: float
) -> Iterator[tuple[Array, float]]:
    """An expanding spiral turn by turn: points (n, 2) round the origin, and the speed of each.

    Inner turns are slower, because an arm can change its direction only so fast.
    """
    turns = int(np.ceil(radius_m / pitch_m))
    for turn in range(turns):
        angle = np.arange(turn * 2 * np.pi, (turn + 1) * 2 * np.pi, _STEP_RAD)
        rho = pitch_m * angle / (2 * np.pi)
        mean_m = pitch_m * (turn + 0.5)
        way = np.stack([rho * np.cos(angle), rho * np.sin(angle)], axis=1)
        yield way, min(speed_m_s, _FASTEST_RAD_S * mean_m)


def spiral_points(radius_m: float, pitch_m: float) -> Iterator[Array]:
    """Points (2,) of single touches along an expanding spiral, one pitch apart from each other."""
    yield np.zeros(2)
    angle, rho = 0.0, pitch_m / 2
    while rho <= radius_m:
        yield rho * np.array([np.cos(angle), np.sin(angle)])
        angle += pitch_m / max(rho, pitch_m / 2)
        rho = pitch_m * (0.5 + angle / (2 * np.pi))
