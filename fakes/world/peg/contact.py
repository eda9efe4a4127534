"""One place at which a peg is touched."""

from dataclasses import dataclass


@dataclass(slots=True)
class Contact:
    """One active slot: force ``stiffness * depth`` along a unit normal on the peg at a lever."""

    slot: int
    depth_m: float
    stiffness_n_m: float
    nx: float
    ny: float
    nz: float
    lx: float
    ly: float
    lz: float
    """Lever (lx, ly, lz) from the tip to the place of contact."""
    around_m: float = 0.0
    """Radius at which the normal turns when the peg moves across it; zero where it keeps."""
    up_m: float = 0.0
    """Lever of the tilt in that turning."""
    twist: bool = False
    """A moment about z alone: depth and stiffness are an angle and N·m/rad, n is the sense."""
