"""Where the rim of a peg crosses a round edge of the face, seen from above.

Seen so, the rim of a tilted peg is an ellipse. Where it stands out over the edge by much more than
the tilt makes it narrower, the crossings of two circles are a good start. In a tight hole they are
not: the ellipse may cross the edge nowhere, or twice on each side of the tilt. There it is followed
from its lowest point up, on each side, to the first place where it crosses.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from fakes.world.peg.attitude import Vector3
from fakes.world.peg.ellipse import Ellipse

_ROUNDS: Final = 12
"""Rounds from the crossing of two circles to that of ellipse and circle; three or four do, but
where the rim only just reaches the edge from outside."""
_NEARLY_UPRIGHT: Final = 0.9999
"""Cosine of a tilt up to which one round does."""
_TIGHT: Final = 10.0
"""Two circles are a start where the rim stands out by so many times what the tilt takes off it."""
_STEPS: Final = 8
_UPWARDS: Final = tuple(
    (angle, math.cos(angle), math.sin(angle))
    for angle in (math.pi * step / _STEPS for step in range(_STEPS + 1))
)
"""Angles from the lowest point of the rim to the highest."""
_HALVINGS: Final = 40
_FOUND_M2: Final = 1e-14
_UP: Vector3 = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Crossing:
    """The rim over an edge."""

    number: int
    """Zero where the rim goes out over the edge, counterclockwise, one where it comes back."""
    x_m: float
    y_m: float
    z_m: float
    """Height of the rim over the face."""
    reach_m: float
    """Deeper than this the wall below the edge pushes, and not the edge. Zero above the edge."""
    push: Vector3
    """Direction in which the edge pushes: at a right angle to both edges.

    Where they cross flatly and the peg is tilted, that is far from upright: such a peg is pushed to
    the middle of the hole.
    """


def crossings(tip: Vector3, axis: Vector3, rim_m: float, edge_m: float) -> Iterator[Crossing]:
    """At most one on each side of the tilt."""
    x, y, _ = tip
    from_hole = math.hypot(x, y)
    stands_out_m = from_hole - abs(rim_m - edge_m)
    if stands_out_m <= 0.0 or from_hole >= rim_m + edge_m:
        return
    rim = Ellipse.of_ring(tip, axis, rim_m)
    narrower_m = 0.5 * rim_m * (axis[0] * axis[0] + axis[1] * axis[1])
    if stands_out_m > _TIGHT * narrower_m:
        reach_m = from_hole + rim_m - edge_m
        towards = math.atan2(-rim.across_m, -rim.along_m)
        cosine = (from_hole**2 + rim_m**2 - edge_m**2) / (2 * from_hole * rim_m)
        half = math.acos(max(-1.0, min(1.0, cosine)))
        rounds = _ROUNDS if axis[2] < _NEARLY_UPRIGHT else 1
        for number, sign in enumerate((1.0, -1.0)):
            angle = _from_circles(rim, towards + sign * half, edge_m, rounds)
            if angle is not None:
                yield _crossing(rim, number, angle, reach_m)
        return
    for side in (1.0, -1.0):
        lowest = _lowest(rim, side, edge_m)
        if lowest is not None:
            angle, goes_out = lowest
            reach_m = _reach(rim, angle, side, edge_m)
            yield _crossing(rim, 0 if goes_out == (side > 0) else 1, angle, reach_m)


def _crossing(rim: Ellipse, number: int, angle: float, reach_m: float) -> Crossing:
    (px, py, pz), (qx, qy, qz) = rim.point(angle), rim.tangent(angle)
    # The edge points along (-py, px, 0) there.
    across = (-qz * px, -qz * py, qx * px + qy * py)
    length = math.copysign(math.hypot(*across), across[2])
    push = _UP
    if length:
        push = (across[0] / length, across[1] / length, across[2] / length)
    return Crossing(number, px, py, pz, reach_m, push)


def _from_circles(rim: Ellipse, direction: float, edge_m: float, rounds: int) -> float | None:
    """Angle of the crossing next to a direction from the middle of the rim."""
    angle = math.atan2(math.sin(direction) * rim.short_m, math.cos(direction) * rim.long_m)
    for _ in range(rounds):
        over, slope = rim.over(angle, edge_m * edge_m)
        if abs(over) < _FOUND_M2:
            return angle
        if abs(slope) < 1e-15:
            return None
        angle -= max(-0.1, min(0.1, over / slope))
    return angle if rounds < _ROUNDS else None


def _lowest(rim: Ellipse, side: float, edge_m: float) -> tuple[float, bool] | None:
    """Angle of the lowest crossing on a side, and whether the rim goes out there on its way up."""
    edge_squared = edge_m * edge_m
    low, most, farthest = 0.0, -math.inf, 0.0
    was_out = False
    for number, (angle, cosine, sine) in enumerate(_UPWARDS):
        over = rim.squared_distance(cosine, side * sine) - edge_squared
        out = over > 0.0
        if number and out != was_out:
            return _between(rim, side * low, side * angle, edge_squared, rising=out), out
        was_out, low = out, angle
        if over > most:
            most, farthest = over, angle
    if was_out:
        return None
    # It may go out between two of these angles.
    step = math.pi / _STEPS
    peak = side * rim.farthest(side * farthest)
    if abs(peak - farthest) > step:
        return None
    if rim.squared_distance(math.cos(peak), side * math.sin(peak)) <= edge_squared:
        return None
    start = side * (min(peak, farthest) - step)
    return _between(rim, start, side * peak, edge_squared, rising=True), True


def _between(rim: Ellipse, low: float, high: float, edge_squared: float, *, rising: bool) -> float:
    """Newton's method that halves the angle where it would leave it."""
    angle = 0.5 * (low + high)
    for _ in range(_HALVINGS):
        over, slope = rim.over(angle, edge_squared)
        if abs(over) < _FOUND_M2:
            break
        if (over > 0.0) == rising:
            high = angle
        else:
            low = angle
        angle = angle - over / slope if slope else low
        if not min(low, high) < angle < max(low, high):
            angle = 0.5 * (low + high)
    return angle


def _reach(rim: Ellipse, angle: float, side: float, edge_m: float) -> float:
    """The wall takes over once the farthest point of the rim is as deep as it stands out."""
    if rim.height_m >= rim.drop_m * math.cos(angle):
        return 0.0
    farthest = rim.farthest(side * math.pi / 2)
    out_m = math.sqrt(rim.squared_distance(math.cos(farthest), math.sin(farthest))) - edge_m
    return out_m + rim.drop_m * (math.cos(angle) - math.cos(farthest))
