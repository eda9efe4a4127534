"""Where the bottom of a tilted peg rests on a face with a hole: exact, and no sampling of its rim.

The peg's bottom is a disc, the face a ring between the hole's mouth and the outer edge. The height
of the disc over the face is linear, so its smallest value lies at the lowest point of the rim,
where the rim crosses an edge of the face, or on the outer edge below the disc.
"""

import math
from collections.abc import Iterator

from fakes.world.peg.attitude import Vector3, axis_of
from fakes.world.peg.crossings import crossings
from fakes.world.peg.edges import edges_of
from fakes.world.peg.fit import Fit

_NEAR_AXIS = 0.01
"""Share of a ring's radius up to which the first order does."""
_CONE_ROUNDS = 4

FacePoint = tuple[int, float, float, float, float, Vector3]
"""Number of the place (0 to 5), x, y, height of the peg's bottom over it (m), by how far the
bottom reaches over the face there (m), and the direction in which the face pushes."""
_UP: Vector3 = (0.0, 0.0, 1.0)


def height_map(
    fit: Fit, x_m: float, y_m: float, tilt_x_rad: float = 0.0, tilt_y_rad: float = 0.0
) -> float:
    """Height of the tip over the face (m) at which a rigid peg coming down touches first.

    x, y are those of the tip from the axis of the hole. ``-inf`` where nothing but the wall of the
    bore is below: the peg goes in. The end of the peg's chamfer on an edge is left out: near the
    hole's axis, where a tilted peg has no more play, it may truly rest higher.
    """
    tip, axis = (x_m, y_m, 0.0), axis_of(tilt_x_rad, tilt_y_rad)
    over = (point[3] for point in carrying_points(fit, tip, axis))
    height_m = max((-one for one in over), default=-math.inf)
    for radius_m, up_m in {(fit.rim_radius_m, 0.0), (fit.peg_radius_m, fit.peg_chamfer_m)}:
        _, _, at_m, rho_m = cone_point(tip, axis, radius_m, up_m)
        if fit.bore_radius_m < rho_m < fit.mouth_radius_m:
            height_m = max(height_m, rho_m - fit.mouth_radius_m - at_m)
    if fit.peg_chamfer_m > 0 and fit.hole_present:
        edges = (edge.rests_at(x_m, y_m, axis) for edge in edges_of(fit))
        height_m = max(height_m, *edges)
    return height_m


def carrying_points(fit: Fit, tip: Vector3, axis: Vector3) -> Iterator[FacePoint]:
    """Places at which the bottom of the peg may rest; ``axis`` has length 1."""
    (x, y, z), (sx, sy, sz) = tip, axis
    rim, mouth, outer = fit.rim_radius_m, fit.mouth_radius_m, fit.outer_radius_m
    lean, from_hole = math.hypot(sx, sy), math.hypot(x, y)
    if lean > 1e-9:
        ex, ey = sx / lean, sy / lean
        px, py = x + rim * sz * ex, y + rim * sz * ey
        rho = math.hypot(px, py)
        if mouth < rho < outer:
            yield 0, px, py, z - rim * lean, min(rho - mouth, outer - rho), _UP
        bx, by = outer * ex, outer * ey
        if outer < math.inf and math.hypot(bx - x, by - y) < rim:
            yield 5, bx, by, z - ((bx - x) * sx + (by - y) * sy) / sz, rim, axis
    if mouth > 0:
        for one in crossings(tip, axis, rim, mouth):
            yield 1 + one.number, one.x_m, one.y_m, one.z_m, one.reach_m, one.push
    if outer < math.inf:
        reach = outer + rim - from_hole
        for one in crossings(tip, axis, rim, outer):
            yield 3 + one.number, one.x_m, one.y_m, one.z_m, reach, one.push


def cone_point(
    tip: Vector3, axis: Vector3, radius: float, up: float
) -> tuple[float, float, float, float]:
    """Point of a ring of the peg that reaches deepest into a cone of 45° about the hole's axis.

    Returns x, y, z and the distance from that axis. To first order the depth at an azimuth e of the
    ring is e·(c + radius·s), with the ring's centre c; far from the axis a few rounds follow.
    """
    (x, y, z), (sx, sy, sz) = tip, axis
    centre = (x + up * sx, y + up * sy, z + up * sz)
    deepest = ring_point(centre, axis, radius, (centre[0] + radius * sx, centre[1] + radius * sy))
    if math.hypot(centre[0], centre[1]) < _NEAR_AXIS * radius:
        return deepest
    for _ in range(_CONE_ROUNDS):
        px, py, _, rho = deepest
        deepest = ring_point(centre, axis, radius, (px / rho + sx / sz, py / rho + sy / sz))
    return deepest


def ring_point(
    centre: Vector3, axis: Vector3, radius: float, towards: tuple[float, float]
) -> tuple[float, float, float, float]:
    """Point of a ring about the peg's axis farthest in a direction, and its distance from z."""
    (cx, cy, cz), (sx, sy, sz), (vx, vy) = centre, axis, towards
    length = math.hypot(vx, vy)
    ex, ey = (vx / length, vy / length) if length > 1e-15 else (1.0, 0.0)
    along = ex * sx + ey * sy
    scale = radius / math.sqrt(max(1.0 - along * along, 1e-12))
    px = cx + scale * (ex - along * sx)
    py = cy + scale * (ey - along * sy)
    return px, py, cz - scale * along * sz, math.hypot(px, py)
