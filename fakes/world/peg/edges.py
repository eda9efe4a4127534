"""Edges of the hole's chamfer against wall and chamfer of the peg.

An edge is a circle. Where it reaches into the peg, the nearest of bottom, chamfer and wall pushes.
The deepest azimuth in the chamfer may lie where the wall is nearer, and the other way round: then
the edge leans on the shoulder between both.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from fakes.world.peg.attitude import Vector3
from fakes.world.peg.contact import Contact
from fakes.world.peg.fit import Fit
from fakes.world.peg.tilted import edge_azimuths, looks_round

TO_CHAMFER: Final = math.sqrt(2.0) - 1.0
"""Slope of the line that halves the angle between a chamfer of 45° and the wall or face at it."""
_HALF: Final = math.sqrt(0.5)
_ROUNDS: Final = 3
"""Rounds that lead to the deepest azimuth in the chamfer."""
_DESCENTS: Final = 8
_ACROSS: Final = math.cos(math.pi / 8)
_ALONG: Final = math.sin(math.pi / 8)
"""Parts of the shoulder's normal, which halves the angle between those of wall and chamfer."""
_ON_CHAMFER, _ON_WALL, _ON_SHOULDER, _ON_OTHER_WALL = 16, 18, 44, 50
_OUTER: Final = 23
"""What the outer edge adds to these numbers."""


@dataclass(frozen=True, slots=True)
class Edge:
    """One circle about the hole's axis."""

    fit: Fit
    radius_m: float
    level_m: float
    number: int

    def contacts(self, tip: Vector3, axis: Vector3) -> Iterator[Contact]:
        """Contacts: at most one on the chamfer, two on the wall, two on the shoulder of the peg."""
        up = (self.level_m - tip[2]) / axis[2]
        offset = (tip[0] + up * axis[0], tip[1] + up * axis[1])
        found = [*self._on_walls(tip, axis, up, offset)]
        if self.fit.peg_chamfer_m > 0:
            found.append(self._on_chamfer(tip, axis, up))
        if any(found):
            yield from (one for one in found if one is not None)
        elif self.fit.peg_chamfer_m > 0:
            yield from self._on_shoulder(tip, axis)

    def rests_at(self, x_m: float, y_m: float, axis: Vector3) -> float:
        """Height of the tip (m) at which the edge meets the chamfer of a peg that comes down.

        ``-inf`` where it passes beside the chamfer.
        """
        height_m, along = self.level_m - self.fit.peg_chamfer_m, -1.0
        for _ in range(_DESCENTS):
            deepest = self._deepest((x_m, y_m, height_m), axis)
            if deepest is None:
                return -math.inf
            _, along, (rx, ry, rz), _ = deepest
            # Lifted by as much, the edge leaves the cone: its reach falls with the height, by one.
            height_m += self.fit.rim_radius_m + along - math.sqrt(rx * rx + ry * ry + rz * rz)
        return height_m if 0.0 <= along <= self.fit.peg_chamfer_m else -math.inf

    def _deepest(self, tip: Vector3, axis: Vector3) -> tuple[Vector3, float, Vector3, float] | None:
        """Point of the edge that reaches deepest into the peg's cone: from the tip, along the peg's
        axis, across it, and the radius at which its azimuth turns. None for a peg in the middle."""
        (x, y, z), (sx, sy, sz), edge = tip, axis, self.radius_m
        up = (self.level_m - z) / sz
        dx, dy = x + up * sx, y + up * sy
        radial = edge
        for _ in range(_ROUNDS):
            vx, vy = dx + radial * sx, dy + radial * sy
            length = math.hypot(vx, vy)
            if length < 1e-15:
                return None
            ex, ey = edge * vx / length, edge * vy / length
            radial = math.hypot(ex - dx, ey - dy)
        lx, ly, lz = ex - x, ey - y, self.level_m - z
        along = lx * sx + ly * sy + lz * sz
        return (lx, ly, lz), along, (lx - along * sx, ly - along * sy, lz - along * sz), length

    def _on_chamfer(self, tip: Vector3, axis: Vector3, up: float) -> Contact | None:
        deepest = self._deepest(tip, axis)
        if deepest is None:
            return None
        lever, along, (rx, ry, rz), length = deepest
        sx, sy, sz = axis
        radial = math.sqrt(rx * rx + ry * ry + rz * rz)
        depth = (self.fit.rim_radius_m + along - radial) * _HALF
        # An edge that is nearer to the bottom or to the wall of the peg belongs to them.
        if not 0.0 < depth <= min(along, self.fit.peg_radius_m - radial):
            return None
        return Contact(
            _ON_CHAMFER + self.number, depth, self.fit.normal_n_m,
            (sx - rx / radial) * _HALF, (sy - ry / radial) * _HALF, (sz - rz / radial) * _HALF,
            *lever, length, up + self.radius_m,
        )  # fmt: skip

    def _on_walls(
        self, tip: Vector3, axis: Vector3, up: float, offset: tuple[float, float]
    ) -> Iterator[Contact | None]:
        """One on the wall of a peg that looks round from above, else one on each side of it."""
        dx, dy = offset
        if looks_round(self.fit, axis):
            distance = math.hypot(dx, dy)
            if distance > 1e-15:
                towards = (dx / distance, dy / distance)
                yield self._on_wall(
                    _ON_WALL, tip, axis,
                    towards=towards, distance=distance, turning=(distance, up),
                )  # fmt: skip
            return
        sides = edge_azimuths(self.radius_m, offset, axis)
        for slot, (ex, ey, around, along) in zip((_ON_WALL, _ON_OTHER_WALL), sides, strict=True):
            turning = (around, up + along)
            distance = dx * ex + dy * ey
            yield self._on_wall(
                slot, tip, axis, towards=(ex, ey), distance=distance, turning=turning
            )

    def _on_wall(
        self,
        slot: int,
        tip: Vector3,
        axis: Vector3,
        *,
        towards: tuple[float, float],
        distance: float,
        turning: tuple[float, float],
    ) -> Contact | None:
        """``distance``: by which the axis of the peg is off in this direction, at this height.
        ``turning``: the last two of the contact."""
        (sx, sy, sz), (ex, ey), edge = axis, towards, self.radius_m
        slope = (ex * sx + ey * sy) / sz
        lengthened = math.sqrt(1.0 + slope * slope)
        over = distance + self.fit.peg_radius_m * lengthened - edge
        if over <= 0.0:
            return None
        lx, ly, lz = edge * ex - tip[0], edge * ey - tip[1], self.level_m - tip[2]
        along = lx * sx + ly * sy + lz * sz
        # Nearer to the end of the peg than to its wall: chamfer or bottom push there.
        nearest = TO_CHAMFER if self.fit.peg_chamfer_m > 0 else 1.0
        if nearest * over >= along - self.fit.peg_chamfer_m:
            return None
        return Contact(
            slot + self.number, over / lengthened, self.fit.normal_n_m,
            -ex / lengthened, -ey / lengthened, slope / lengthened,
            lx, ly, lz, *turning,
        )  # fmt: skip

    def _on_shoulder(self, tip: Vector3, axis: Vector3) -> Iterator[Contact]:
        """Contacts where the edge is as high on the peg as the end of its chamfer."""
        (x, y, z), (sx, sy, sz), edge = tip, axis, self.radius_m
        lean = math.hypot(sx, sy)
        lz = self.level_m - z
        needed = (self.fit.peg_chamfer_m - lz * sz + x * sx + y * sy) / edge
        if abs(needed) >= lean:
            return
        towards, half = math.atan2(sy, sx), math.acos(needed / lean)
        for place, sign in enumerate((1.0, -1.0)):
            angle = towards + sign * half
            lx, ly = edge * math.cos(angle) - x, edge * math.sin(angle) - y
            along = self.fit.peg_chamfer_m
            rx, ry, rz = lx - along * sx, ly - along * sy, lz - along * sz
            radial = math.sqrt(rx * rx + ry * ry + rz * rz)
            over = self.fit.peg_radius_m - radial
            if over > 0.0:
                push = _ACROSS / radial
                yield Contact(
                    _ON_SHOULDER + 2 * (self.number > 0) + place, over * _ACROSS,
                    self.fit.normal_n_m,
                    sx * _ALONG - rx * push, sy * _ALONG - ry * push, sz * _ALONG - rz * push,
                    lx, ly, lz,
                )  # fmt: skip


def edges_of(fit: Fit) -> tuple[Edge, ...]:
    """The edge of the bore, and the outer one of a chamfer."""
    inner = Edge(fit, fit.bore_radius_m, -fit.hole_chamfer_m, 0)
    if fit.hole_chamfer_m == 0:
        return (inner,)
    return inner, Edge(fit, fit.mouth_radius_m, 0.0, _OUTER)
