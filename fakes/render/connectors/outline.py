"""Convex outlines with rounded corners: the D of a connector, rectangles."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.lattice import Picture, Window, window_around
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import surface_map, to_pixels

_SLANT_DEG = 10.0
"""Slant of the short sides of a D."""
_FAR = np.float32(40.0)


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """Points with ``sides @ (x, y, 1) < 0`` for every side; corners rounded by ``corner_m``."""

    sides: Array
    """Unit normal and offset of each side, shape (4, 3)."""
    corner_m: float
    reach_m: float
    """No point is farther from the outline's middle."""
    middle_m: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def rectangle(
        cls, width_m: float, height_m: float, middle_m: tuple[float, float] = (0.0, 0.0)
    ) -> Self:
        """Sides along x and y."""
        return cls._trapezoid(width_m, height_m, 0.0, 0.2e-3, middle_m)

    @classmethod
    def d_shape(cls, width_m: float, height_m: float) -> Self:
        """Longest at +y, as the row of eight is longer than that of seven."""
        return cls._trapezoid(width_m, height_m, np.radians(_SLANT_DEG), 0.4e-3, (0.0, 0.0))

    @classmethod
    def _trapezoid(
        cls,
        width_m: float,
        height_m: float,
        slant_rad: float,
        corner_m: float,
        middle_m: tuple[float, float],
    ) -> Self:
        c, s = np.cos(slant_rad), np.sin(slant_rad)
        sides = np.array(
            [
                [0.0, 1.0, -height_m / 2],
                [0.0, -1.0, -height_m / 2],
                [c, -s, -c * width_m / 2],
                [-c, -s, -c * width_m / 2],
            ]
        )
        reach_m = float(np.hypot(width_m, height_m)) / 2 + height_m * np.tan(slant_rad)
        return cls(sides, corner_m, reach_m, middle_m)

    def outside(self, x: Picture, y: Picture, grown_m: float = 0.0) -> Picture:
        """Roughly the distance from the outline; negative inside of it."""
        x0, y0 = self.middle_m
        # A sum of exponentials is a maximum with rounded corners. Unlimited they would overflow
        # outside, and be slow where they vanish.
        total = np.zeros_like(x)
        for nx, ny, offset in (self.sides / self.corner_m).astype(np.float32):
            side = nx * x + ny * y
            side += offset - np.float32((nx * x0 + ny * y0) + grown_m / self.corner_m)
            total += np.exp(np.clip(side, -_FAR, _FAR, out=side), out=side)
        return np.asarray(np.float32(self.corner_m) * np.log(total), dtype=np.float32)

    def window(
        self, view: View, pose: RigidTransform, heights_m: tuple[float, ...], grown_m: float = 0.0
    ) -> Window | None:
        """Part of the image that holds the outline at these heights, not divided."""
        reach = self.reach_m + grown_m
        x0, y0 = self.middle_m
        corners = np.array(
            [
                [x0 + u * reach, y0 + v * reach, z]
                for u in (-1, 0, 1)
                for v in (-1, 0, 1)
                for z in heights_m
            ]
        )
        return window_around(view, to_pixels(view, pose, corners), 3, 1)

    def cover(
        self,
        view: View,
        pose: RigidTransform,
        window: Window,
        z_m: float,
        grown_m: float = 0.0,
    ) -> Picture:
        """Share of each pixel that sees the inside of the outline at a height.

        Good to a tenth of a pixel: as if every edge ran along the rows or columns.
        """
        x, y = (part.astype(np.float32) for part in surface_map(view, pose, window, z_m=z_m))
        across_m = float(np.hypot(x[0, 1] - x[0, 0], y[0, 1] - y[0, 0]))
        cover = 0.5 - self.outside(x, y, grown_m) / np.float32(across_m)
        return np.asarray(np.clip(cover, 0.0, 1.0), dtype=np.float32)
