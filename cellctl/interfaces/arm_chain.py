"""The chain of a six-axis arm as its driver's settings state it, for whoever plans offline."""

from dataclasses import dataclass

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class ArmChain:
    """Denavit-Hartenberg parameters (classic convention) and the limits of the joints."""

    dh: Array
    """Shape (6, 4): theta in rad, added to the joint's angle; d in m; a in m; alpha in rad."""
    lower_rad: Array
    """Shape (6,)."""
    upper_rad: Array
    """Shape (6,)."""
