"""Rays of the cells of a window near the axis of something round.

Between two parallel planes a ray moves along a straight line, so its course follows from where it
meets both planes.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.lattice import Window
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import surface_map


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """Rays of all cells relative to an axis: at the face, and their change per metre of depth."""

    x: Array
    y: Array
    slope_x: Array
    slope_y: Array

    @classmethod
    def through(
        cls,
        view: View,
        pose: RigidTransform,
        window: Window,
        *,
        centre_m: tuple[float, float],
        depth_m: float,
    ) -> Self:
        """Rays about an axis through ``centre_m`` in the frame of a body, from z = 0 down."""
        x, y = surface_map(view, pose, window)
        x_end, y_end = surface_map(view, pose, window, z_m=-depth_m)
        slope_x, slope_y = (x_end - x) / depth_m, (y_end - y) / depth_m
        return cls(x - centre_m[0], y - centre_m[1], slope_x, slope_y)

    def at(self, depth_m: float | Array) -> tuple[Array, Array]:
        """Place relative to the axis at a depth."""
        return self.x + depth_m * self.slope_x, self.y + depth_m * self.slope_y

    def radius(self, depth_m: float | Array) -> Array:
        """Distance from the axis at a depth."""
        return np.hypot(*self.at(depth_m))

    def wall_depth(self, radius_m: float) -> Array:
        """Depth at which a ray from inside meets a cylinder; 0 for rays that start outside."""
        a = self.slope_x**2 + self.slope_y**2 + 1e-12
        b = self.x * self.slope_x + self.y * self.slope_y
        # The ray meets the cylinder where |p + d s|² = r²: a quadratic equation in the depth d. Of
        # its two solutions the larger one is the wall that the ray runs into.
        c = self.x**2 + self.y**2 - radius_m**2
        return np.asarray((-b + np.sqrt(np.maximum(b * b - a * np.minimum(c, 0), 0))) / a)
