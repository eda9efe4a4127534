"""A hole as the drawing gives it."""

from dataclasses import dataclass

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class Hole:
    """One feature with its nominal geometry in the part frame."""

    name: str
    kind: str
    """A key of ``cellctl.vision.features.known_kinds.KINDS``."""
    diameter_m: float
    """Diameter of the rim that carries the nominal centre."""
    position_m: Array
    """Shape (3,)."""
    countersink_m: float | None = None
    """Diameter of the countersink's outer rim."""
    outward: Array | None = None
    """Unit vector out of the face that is seen, shape (3,); None when the drawing does not say."""
    position_sigma_m: float = 0.0
    """How far holes of this part lie off their position, standard deviation along x and along y."""
