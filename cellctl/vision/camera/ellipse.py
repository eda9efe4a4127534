"""Ellipses: as a value, and as the image of a circle."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class Ellipse:
    """An ellipse in raw pixels."""

    centre_px: Array
    """Shape (2,)."""
    semi_axes_px: tuple[float, float]
    """Major, minor."""
    angle_rad: float
    """Angle of the major axis from the axis of the columns."""

    @property
    def area_px2(self) -> float:
        """Enclosed area."""
        return float(np.pi * self.semi_axes_px[0] * self.semi_axes_px[1])

    @property
    def perimeter_px(self) -> float:
        """Circumference, by Ramanujan's second approximation."""
        a, b = self.semi_axes_px
        # The perimeter of an ellipse has no closed form. For the axes that a tilted circle shows,
        # the error of this approximation is far below that of the fit.
        h = ((a - b) / (a + b)) ** 2
        return float(np.pi * (a + b) * (1.0 + 3.0 * h / (10.0 + np.sqrt(4.0 - 3.0 * h))))

    def points(self, count: int = 64) -> Array:
        """Points on the ellipse, shape (count, 2)."""
        t = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
        c, s = np.cos(self.angle_rad), np.sin(self.angle_rad)
        local = np.column_stack(
            [self.semi_axes_px[0] * np.cos(t), self.semi_axes_px[1] * np.sin(t)]
        )
        return np.asarray(self.centre_px + local @ np.array([[c, s], [-s, c]]))


def ellipse_of_circle(centre_px: Array, jacobian: Array) -> Ellipse:
    """Image of a circle to first order; ``jacobian`` (2, 2) maps the unit circle to pixels."""
    axes, sizes, _ = np.linalg.svd(jacobian)
    angle_rad = float(np.arctan2(axes[1, 0], axes[0, 0]))
    return Ellipse(centre_px, (float(sizes[0]), float(sizes[1])), angle_rad)
