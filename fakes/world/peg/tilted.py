"""Where a peg that is tilted far meets the round wall of a tight hole: a place on each side.

Seen along the axis of the hole, its section is longer and its end narrower than a circle. As long
as both are so by little against the clearance, the place farthest out lies in the direction in
which the peg stands off the middle. Beyond, two places are farthest out, one on each side, and the
peg can stand against both at once.
"""

import math
from collections.abc import Iterator
from typing import Final

from fakes.world.peg.attitude import Vector3
from fakes.world.peg.ellipse import Ellipse
from fakes.world.peg.fit import Fit

_ROUND_SHARE: Final = 0.05
"""Share of the clearance by which the section of a tilted peg may be longer and still count as
round. What changes there at once is far less than arm and contact give under a newton."""
_ROUNDS: Final = 20
_STEP_RAD: Final = 0.3
_FOUND_RAD: Final = 1e-7


def looks_round(fit: Fit, axis: Vector3) -> bool:
    """Whether the tilt of the peg does not show in its section, against the clearance."""
    lean_squared = axis[0] * axis[0] + axis[1] * axis[1]
    return 0.5 * fit.peg_radius_m * lean_squared <= _ROUND_SHARE * fit.clearance_m


def edge_azimuths(
    radius_m: float, offset: tuple[float, float], axis: Vector3
) -> Iterator[tuple[float, float, float, float]]:
    """Unit vector x, y to the point of an edge that reaches deepest into the wall of the peg, on
    each side of its tilt; the radius at which it turns, and how far along the axis it lies from the
    place of the peg's axis at the height of the edge.

    ``offset``: that place, from the middle of the edge. An edge point R e is nearest to the axis
    where e points along v = d + ((R e - d)·s) s, with the offset d and the axis s. There v is as
    long as e·v, and across e it changes by R (t·s)² with the azimuth, where t is across e.
    """
    (dx, dy), (sx, sy, _) = offset, axis
    for side in (0.0, math.pi):
        azimuth = math.atan2(sy, sx) + side
        for _ in range(_ROUNDS):
            ex, ey = math.cos(azimuth), math.sin(azimuth)
            along = (radius_m * ex - dx) * sx + (radius_m * ey - dy) * sy
            vx, vy = dx + along * sx, dy + along * sy
            across, leans = ex * vy - ey * vx, ex * sy - ey * sx
            turning = ex * vx + ey * vy - radius_m * leans * leans
            step = across / turning if turning > 0.0 else math.copysign(_STEP_RAD, across)
            if abs(step) < _FOUND_RAD:
                break
            azimuth += max(-_STEP_RAD, min(_STEP_RAD, step))
        yield ex, ey, max(turning / (1.0 - leans * leans), 0.0), along


def rim_points(
    centre: Vector3, axis: Vector3, radius_m: float
) -> Iterator[tuple[float, float, float, float, float]]:
    """x, y, z of the points of a ring about the peg's axis that are farthest from the axis of the
    hole, on each side of the tilt; that distance, and the radius at which its direction turns."""
    ring = Ellipse.of_ring(centre, axis, radius_m)
    for side in (1.0, -1.0):
        angle = ring.farthest(side * math.pi / 2)
        x, y, z = ring.point(angle)
        tx, ty, _ = ring.tangent(angle)
        rho = math.hypot(x, y)
        _, second = ring.farther(angle)
        bend = second - (tx * tx + ty * ty)
        around = rho * second / bend if bend < 0.0 else 0.0
        yield x, y, z, rho, max(around, 0.0)
