"""A ring about the axis of a tilted peg, seen along the axis of the hole: an ellipse."""

import math
from dataclasses import dataclass
from typing import Final, Self

from fakes.world.peg.attitude import Vector3

_ROUNDS: Final = 20
_STEP_RAD: Final = 0.3
_FOUND_RAD: Final = 1e-6
"""After a step of Newton's method that is so short, the next would be far shorter."""


@dataclass(slots=True)
class Ellipse:
    """Angles count from the lowest point of the ring, towards the left of the tilt.

    ``along`` and ``across`` are the middle of the ring from the axis of the hole, in the direction
    of the tilt and to its left; half its width along is ``short``, across ``long``.
    """

    along_m: float
    across_m: float
    short_m: float
    long_m: float
    height_m: float
    drop_m: float
    """By which the lowest point lies below the middle."""
    ax: float
    ay: float
    """Direction of the tilt."""

    @classmethod
    def of_ring(cls, centre: Vector3, axis: Vector3, radius_m: float) -> Self:
        """The ring of a radius about the axis of a peg."""
        (cx, cy, cz), (sx, sy, sz) = centre, axis
        lean = math.hypot(sx, sy)
        ax, ay = (sx / lean, sy / lean) if lean > 0.0 else (1.0, 0.0)
        return cls(
            cx * ax + cy * ay, cy * ax - cx * ay, radius_m * sz, radius_m,
            cz, radius_m * lean, ax, ay,
        )  # fmt: skip

    def squared_distance(self, cosine: float, sine: float) -> float:
        """From the axis of the hole, at an angle."""
        p, q = self.along_m + self.short_m * cosine, self.across_m + self.long_m * sine
        return p * p + q * q

    def over(self, angle: float, edge_squared: float) -> tuple[float, float]:
        """By how much the squared distance is above that of an edge, and its derivative."""
        cosine, sine = math.cos(angle), math.sin(angle)
        p, q = self.along_m + self.short_m * cosine, self.across_m + self.long_m * sine
        slope = 2.0 * (q * self.long_m * cosine - p * self.short_m * sine)
        return p * p + q * q - edge_squared, slope

    def point(self, angle: float) -> Vector3:
        """x, y, z at an angle."""
        cosine, sine = math.cos(angle), math.sin(angle)
        p, q = self.along_m + self.short_m * cosine, self.across_m + self.long_m * sine
        z = self.height_m - self.drop_m * cosine
        return p * self.ax - q * self.ay, p * self.ay + q * self.ax, z

    def tangent(self, angle: float) -> Vector3:
        """Derivative of the point by the angle."""
        sine = math.sin(angle)
        p, q = -self.short_m * sine, self.long_m * math.cos(angle)
        return p * self.ax - q * self.ay, p * self.ay + q * self.ax, self.drop_m * sine

    def farther(self, angle: float) -> tuple[float, float]:
        """Both derivatives of half the squared distance from the hole's axis by the angle."""
        cosine, sine = math.cos(angle), math.sin(angle)
        p, q = self.along_m + self.short_m * cosine, self.across_m + self.long_m * sine
        u, v = self.short_m * sine, self.long_m * cosine
        second = v * v - q * self.long_m * sine + u * u - p * self.short_m * cosine
        return q * v - p * u, second

    def farthest(self, angle: float) -> float:
        """Angle of the point farthest from the hole's axis, the next from a start."""
        for _ in range(_ROUNDS):
            first, second = self.farther(angle)
            step = -first / second if second < 0.0 else math.copysign(_STEP_RAD, first)
            angle += max(-_STEP_RAD, min(_STEP_RAD, step))
            if abs(step) < _FOUND_RAD:
                break
        return angle
