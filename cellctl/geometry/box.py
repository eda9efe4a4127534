"""A box along the axes of a frame, and whether a way through that frame meets it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import MM, Array


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Corners in m, each of shape (3,); its faces belong to it."""

    lower_m: Array
    upper_m: Array

    @classmethod
    def from_mm(cls, lower_mm: Sequence[float], upper_mm: Sequence[float]) -> "Box":
        """The box with these corners, as they are written."""
        return cls(np.array(lower_mm, float) * MM, np.array(upper_mm, float) * MM)

    def grown(self, by_m: float) -> "Box":
        """The box with every face so far outside of this one's."""
        return Box(self.lower_m - by_m, self.upper_m + by_m)

    def holds(self, point_m: Array) -> bool:
        """Whether a point, shape (3,), lies in the box; a place that is not a number does."""
        if not np.isfinite(point_m).all():
            return True
        return bool(np.all((point_m >= self.lower_m) & (point_m <= self.upper_m)))

    def to_face_m(self, points_m: Array, axis: int, *, upper: bool) -> Array:
        """How far each point, shape (n, 3), lies before the lower or upper face across an axis:
        shape (n,), negative beyond it."""
        if upper:
            return np.asarray(self.upper_m[axis] - points_m[:, axis])
        return np.asarray(points_m[:, axis] - self.lower_m[axis])

    def meets(self, points_m: Array) -> bool:
        """Whether the straight lines through the points, shape (n, 3), meet the box anywhere.

        Each line is cut by the three pairs of planes, and meets the box where the three stretches
        in between overlap (Kay and Kajiya, SIGGRAPH 1986). A place that is not a number meets it.
        """
        if not np.isfinite(points_m).all():
            return True
        begin_m, end_m = points_m, np.vstack([points_m[1:], points_m[-1:]])
        way_m = end_m - begin_m
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            to_lower, to_upper = (self.lower_m - begin_m) / way_m, (self.upper_m - begin_m) / way_m
        # A line along two planes lies between them everywhere or nowhere.
        along = way_m == 0.0
        between = (begin_m >= self.lower_m) & (begin_m <= self.upper_m)
        enters = np.where(along, np.where(between, -np.inf, np.inf), np.minimum(to_lower, to_upper))
        leaves = np.where(along, np.where(between, np.inf, -np.inf), np.maximum(to_lower, to_upper))
        first, last = enters.max(axis=1), leaves.min(axis=1)
        return bool(np.any((first <= last) & (first <= 1.0) & (last >= 0.0)))
