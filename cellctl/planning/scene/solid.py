"""A rigid body of the model, in the frame of what carries it."""

from dataclasses import dataclass

from cellctl.geometry.pose import Array
from cellctl.planning.model.shapes import Shape


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """One body with one shape."""

    name: str
    """As in the model file; with the arm's name before it where an arm moves it."""
    arm: str | None
    """The arm that moves it; None for a fixture."""
    link: int
    """Whose frame carries it, 0 to 6; 0 for a fixture."""
    link_T_shape: Array
    """Shape (4, 4): the shape in the frame of its link, a fixture's in the frame of the cell."""
    shape: Shape
    margin_m: float
    stand_in: bool
    absent_in: frozenset[int] = frozenset()
    """Procedures before which a person takes it away."""

    @property
    def still(self) -> bool:
        """Whether nothing moves it."""
        return self.arm is None or self.link == 0
