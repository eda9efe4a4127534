"""Shape of a peg and its hole, and what they are made of."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Keys:
    """Keys that let the plug in at one yaw only."""

    depth_m: float
    """Depth at which they meet their grooves."""
    window_rad: float
    """Half width of the yaw that enters, and the play inside."""
    present: bool = True
    """False for a socket whose grooves fit at no yaw."""


@dataclass(frozen=True, slots=True)
class Burr:
    """A chip on the wall of the bore, with a front at 45°."""

    depth_m: float
    height_m: float
    azimuth_rad: float = 0.0


@dataclass(frozen=True, slots=True)
class Fit:
    """A round peg with a chamfer at 45° and a bore with one, in a face of any size.

    The frame of the hole has its origin in the middle of the mouth on the face, z out of the hole.
    """

    peg_radius_m: float
    bore_radius_m: float
    depth_m: float
    """Depth below the face at which the bottom of the peg rests."""
    hole_chamfer_m: float = 0.0
    peg_chamfer_m: float = 0.0
    outer_radius_m: float = math.inf
    """Radius of the part that carries the hole and stands proud of its panel."""
    proud_m: float = math.inf
    friction: float = 0.2
    normal_n_m: float = 2e7
    """Ten times what the arm has in any axis, or more: a softer wall lets a tilted peg in."""
    contact_forces: tuple[tuple[float, float], ...] = ()
    """Depth (m) and axial force (N) of the contacts inside, rising depth, linear between."""
    keys: Keys | None = None
    burr: Burr | None = None
    hole_present: bool = True

    def __post_init__(self) -> None:
        """Raises ``ValueError`` for shapes that do not exist."""
        rim_m = self.peg_radius_m - self.peg_chamfer_m
        if min(rim_m, self.bore_radius_m, self.depth_m, self.normal_n_m) <= 0:
            raise ValueError("radii, depth and stiffness of a peg and its hole are above zero")
        if min(self.hole_chamfer_m, self.peg_chamfer_m, self.friction) < 0:
            raise ValueError("chamfers and friction of a peg and its hole are zero or more")
        if self.outer_radius_m <= self.mouth_radius_m:
            raise ValueError("the part that carries the hole is wider than the hole's mouth")

    @property
    def clearance_m(self) -> float:
        """Radial; negative for a peg that does not go in."""
        return self.bore_radius_m - self.peg_radius_m

    @property
    def rim_radius_m(self) -> float:
        """Radius of the bottom circle of the peg."""
        return self.peg_radius_m - self.peg_chamfer_m

    @property
    def mouth_radius_m(self) -> float:
        """Radius of the hole in the plane of the face."""
        return self.bore_radius_m + self.hole_chamfer_m if self.hole_present else 0.0

    @property
    def floor_m(self) -> float:
        """Height at which the bottom of the peg rests, negative.

        A peg that is too thick stops where its own radius is that of the hole's chamfer: pressed
        against springs of the wall it would slide in.
        """
        if self.clearance_m > 0:
            return -self.depth_m
        narrows_m = max(self.mouth_radius_m - self.peg_radius_m, 0.0)
        return -(narrows_m + self.peg_chamfer_m) if narrows_m else 0.0
