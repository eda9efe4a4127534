"""Contacts of a peg with its hole, each slot with one exact extreme point.

A slot is a pair of features that can touch: bottom rim and bore, mouth edge and wall of the peg,
rings and cones of both chamfers, rim and face, and so on. Two slots on opposite sides are a
two-point contact; nothing is special about it. The switches between slots use the height of the
tilted extreme point: with that of the axis, gaps between slots would let the peg jump.
"""

import math
from typing import Final

from fakes.world.peg.attitude import Pose6, Vector3, axis_of
from fakes.world.peg.contact import Contact
from fakes.world.peg.edges import TO_CHAMFER, edges_of
from fakes.world.peg.face import carrying_points, cone_point, ring_point
from fakes.world.peg.fit import Fit
from fakes.world.peg.tilted import looks_round, rim_points

_HALF: Final = math.sqrt(0.5)
_RIM: Final = tuple((math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in range(8))
_FLAT: Final = 1e-3
"""Tilt (rad) at which the lowest point of the rim takes over from points all round it."""
_LEANING: Final = 20 * _FLAT
"""Tilt beyond which those carry no more."""
# First number of each kind of slot, with as many after it as the kind has places; ``edges`` has
# some between. They must differ, because friction finds the bristle of a contact by its number.
_FACE, _RIM_ON_FACE, _RINGS = 0, 6, 14
_RIM_ON_WALL, _FLOOR, _OUTER, _PANEL, _KEYS, _KEY_PLAY, _BURR, _WEDGED = (
    17, 19, 23, 24, 28, 29, 30, 31,
)  # fmt: skip
_RIM_ON_OTHER_WALL = 31
"""What the other side of a tilted peg adds to the number of its rim."""


def among_contacts(fit: Fit, pose: Pose6) -> bool:
    """Whether the peg stands so deep in its hole that contacts inside rub at it."""
    if not fit.contact_forces or pose[2] >= -fit.contact_forces[0][0]:
        return False
    return math.hypot(pose[0], pose[1]) < fit.mouth_radius_m


class Slots:
    """All that can touch between the peg and the hole of a fit."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self._rim, self._radius = fit.rim_radius_m, fit.peg_radius_m
        self._bore, self._mouth = fit.bore_radius_m, fit.mouth_radius_m
        self._hole_chamfer, self._peg_chamfer = fit.hole_chamfer_m, fit.peg_chamfer_m
        self._outer, self._k = fit.outer_radius_m, fit.normal_n_m
        self._rings = ((0, self._rim, 0.0), (1, self._radius, self._peg_chamfer))
        self._edges = edges_of(fit)
        self._enters = fit.hole_present and fit.clearance_m > 0

    def active(self, pose: Pose6) -> list[Contact]:
        """Every contact at a pose."""
        tip = x, y, z = pose[0], pose[1], pose[2]
        s = axis_of(pose[3], pose[4])
        found: list[Contact] = []
        if z > self._radius * math.hypot(s[0], s[1]):
            return found
        from_hole = math.hypot(x, y)
        overhang = from_hole + self._rim - self._mouth
        if overhang > -z - self._rim * math.hypot(s[0], s[1]) and overhang > 0:
            self._on_face(found, tip, s)
        if self._outer < math.inf and from_hole > self._outer:
            self._beside(found, tip, s)
        if self._mouth > 0 and from_hole < self._mouth:
            self._in_hole(found, pose, s)
        return found

    def free(self, pose: Pose6) -> bool:
        """True where nothing acts on the peg, contacts inside a connector included."""
        return not among_contacts(self.fit, pose) and not self.active(pose)

    def _on_face(self, found: list[Contact], tip: Vector3, s: Vector3) -> None:
        x, y, z = tip
        sx, sy, _ = s
        lean = math.hypot(sx, sy)
        # A flat peg has no lowest point: its place would jump round the rim.
        tilted = lean / (lean + _FLAT)
        for place, px, py, pz, reach, push in carrying_points(self.fit, tip, s):
            # Deeper than it reaches over the face: that is the wall's.
            if 0.0 < -pz <= reach:
                stiffness = self._k if place else self._k * tilted
                depth, lever = -pz * push[2], (px - x, py - y, pz - z)
                found.append(Contact(_FACE + place, depth, stiffness, *push, *lever))
        if lean > _LEANING:
            return
        stiffness = 0.5 * self._k * (1.0 - tilted)
        for place, (ex, ey) in enumerate(_RIM):
            lx, ly = self._rim * ex, self._rim * ey
            lz = -(lx * sx + ly * sy)
            depth = -z - lz
            if depth <= 0.0:
                continue
            rho = math.hypot(x + lx, y + ly)
            if depth <= min(rho - self._mouth, self._outer - rho):
                slot = _RIM_ON_FACE + place
                found.append(Contact(slot, depth, stiffness, 0.0, 0.0, 1.0, lx, ly, lz))

    def _beside(self, found: list[Contact], tip: Vector3, s: Vector3) -> None:
        """Wall of the peg against the outer wall of the plug, and the panel below."""
        x, y, z = tip
        sx, sy, sz = s
        up = -z / sz
        ax, ay = x + up * sx, y + up * sy
        distance = math.hypot(ax, ay)
        depth = self._outer + self._radius - distance
        if 0.0 < depth < up:
            ex, ey = ax / distance, ay / distance
            lever = (self._outer * ex - x, self._outer * ey - y, -z)
            found.append(Contact(_OUTER, depth, self._k, ex, ey, 0.0, *lever))
        if z < self._rim * math.hypot(sx, sy) - self.fit.proud_m:
            self._stand_on(found, _PANEL, -self.fit.proud_m, z, s)

    def _stand_on(
        self, found: list[Contact], slot: int, floor: float, z: float,
        s: Vector3,
    ) -> None:  # fmt: skip
        for place in range(4):
            ex, ey = _RIM[2 * place]
            lx, ly = self._rim * ex, self._rim * ey
            lz = -(lx * s[0] + ly * s[1])
            if z + lz < floor:
                depth = floor - z - lz
                found.append(Contact(slot + place, depth, 0.5 * self._k, 0.0, 0.0, 1.0, lx, ly, lz))

    def _in_hole(self, found: list[Contact], pose: Pose6, s: Vector3) -> None:
        tip = pose[0], pose[1], pose[2]
        z = pose[2]
        if self._hole_chamfer > 0:
            self._rings_on_cone(found, tip, s)
        if self._enters:
            self._rim_on_wall(found, tip, s)
            for edge in self._edges:
                found.extend(edge.contacts(tip, s))
        else:
            self._ring_wedged(found, tip, s)
        floor = self.fit.floor_m
        if z < floor + self._rim * math.hypot(s[0], s[1]):
            self._stand_on(found, _FLOOR, floor, z, s)
        if self.fit.keys is not None and -z > self.fit.keys.depth_m:
            self._on_keys(found, z, pose[5])
        if self.fit.burr is not None:
            self._on_burr(found, tip, s)

    def _rings_on_cone(self, found: list[Contact], tip: Vector3, s: Vector3) -> None:
        x, y, z = tip
        rings = self._rings if self._peg_chamfer > 0 and self._enters else self._rings[:1]
        for number, radius, up in rings:
            # No point of the ring is farther out than this.
            if math.hypot(x + up * s[0], y + up * s[1]) + radius <= self._bore:
                continue
            px, py, pz, rho = cone_point(tip, s, radius, up)
            depth = (rho - self._mouth - pz) * _HALF
            below = self._mouth - TO_CHAMFER * pz
            on_cone = self._bore < rho < below and pz >= self._bore - rho - self._hole_chamfer
            if depth > 0 and on_cone:
                ex, ey = px / rho, py / rho
                around = math.hypot(x + (up + radius) * s[0], y + (up + radius) * s[1])
                found.append(
                    Contact(
                        _RINGS + number, depth, self._k, -ex * _HALF, -ey * _HALF, _HALF,
                        px - x, py - y, pz - z, around, up + radius,
                    )
                )  # fmt: skip

    def _ring_wedged(self, found: list[Contact], tip: Vector3, s: Vector3) -> None:
        """A peg that is too thick, in the cone all round: no single point reaches deepest."""
        x, y, z = tip
        up = self._peg_chamfer
        cx, cy, cz = x + up * s[0], y + up * s[1], z + up * s[2]
        for place, (ex, ey) in enumerate(_RIM):
            px, py = cx + self._radius * ex, cy + self._radius * ey
            pz = cz - self._radius * (ex * s[0] + ey * s[1])
            rho = math.hypot(px, py)
            depth = (rho - self._mouth - pz) * _HALF
            if depth > 0 and rho < self._mouth:
                nx, ny = -px / rho * _HALF, -py / rho * _HALF
                lever = (px - x, py - y, pz - z)
                stiffness = 0.5 * self._k
                found.append(Contact(_WEDGED + place, depth, stiffness, nx, ny, _HALF, *lever))

    def _rim_on_wall(self, found: list[Contact], tip: Vector3, s: Vector3) -> None:
        x, y, z = tip
        sx, sy, sz = s
        up = self._peg_chamfer
        cx, cy, _ = centre = (x + up * sx, y + up * sy, z + up * sz)
        if looks_round(self.fit, s):
            farthest = ring_point(centre, s, self._radius, (cx, cy))
            points = [(*farthest, math.hypot(cx, cy))]
        else:
            points = [*rim_points(centre, s, self._radius)]
        for place, (px, py, pz, rho, around) in enumerate(points):
            depth = rho - self._bore
            if depth > 0.0 and pz + self._hole_chamfer < -depth:
                found.append(
                    Contact(
                        _RIM_ON_WALL + _RIM_ON_OTHER_WALL * place, depth, self._k,
                        -px / rho, -py / rho, 0.0, px - x, py - y, pz - z, around, up,
                    )
                )  # fmt: skip

    def _on_keys(self, found: list[Contact], z: float, yaw: float) -> None:
        """Standing on the grooves' ends, or turned back by their flanks."""
        keys = self.fit.keys
        assert keys is not None
        deep = -z - keys.depth_m
        beyond = abs(yaw) - keys.window_rad if keys.present else math.pi
        if deep <= beyond * self._radius:
            found.append(Contact(_KEYS, deep, self._k, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
        elif beyond > 0:
            stiffness = self._k * self._radius**2
            sense = -math.copysign(1.0, yaw)
            found.append(
                Contact(_KEY_PLAY, beyond, stiffness, 0.0, 0.0, sense, 0.0, 0.0, 0.0, twist=True)
            )

    def _on_burr(self, found: list[Contact], tip: Vector3, s: Vector3) -> None:
        x, y, z = tip
        burr = self.fit.burr
        assert burr is not None
        ex, ey = math.cos(burr.azimuth_rad), math.sin(burr.azimuth_rad)
        up = self._peg_chamfer
        cx, cy, cz = x + up * s[0], y + up * s[1], z + up * s[2]
        px, py, pz, _ = ring_point((cx, cy, cz), s, self._radius, (ex, ey))
        ramp = -burr.depth_m - pz
        front = 0.0 < ramp < burr.height_m
        depth = px * ex + py * ey - self._bore + min(ramp, burr.height_m)
        if ramp <= 0.0 or depth <= 0.0:
            return
        out, rise = (_HALF, _HALF) if front else (1.0, 0.0)
        found.append(
            Contact(
                _BURR, depth * out, self._k, -ex * out, -ey * out, rise,
                px - x, py - y, pz - z,
            )
        )  # fmt: skip
