"""The narrowest gap of a scene."""

from dataclasses import dataclass

from cellctl.geometry.pose import MM, Array


@dataclass(frozen=True, slots=True, eq=False)
class NarrowestGap:
    """Two bodies with the least room beyond what has to stay free between them."""

    first: str
    second: str
    distance_m: float
    """Distance between the two; 0 or less where they touch."""
    required_m: float
    place_m: Array
    """The middle between the two nearest points, shape (3,), in the frame of the cell."""

    @property
    def slack_m(self) -> float:
        """What the gap is wider than it has to be; below 0 it is too narrow."""
        return self.distance_m - self.required_m

    def __str__(self) -> str:
        place = ", ".join(f"{value / MM:.0f}" for value in self.place_m)
        return (
            f"{self.first} and {self.second} at ({place}) mm: {max(self.distance_m, 0) / MM:.1f} mm"
            f" apart, {self.required_m / MM:.1f} mm required"
        )
