"""Ellipses: as a value, from points, and as the image of a circle."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class Ellipse:
    """An ellipse in raw pixels."""

    centre_px: Array
    """Shape (2,)."""
    semi_axes_px: tuple[float, float]
    """Major, minor."""
    angle_rad: float
    """Of the major axis from the columns' axis."""

    @property
    def area_px2(self) -> float:
        """Enclosed area."""
        return float(np.pi * self.semi_axes_px[0] * self.semi_axes_px[1])

    @property
    def perimeter_px(self) -> float:
        """Circumference, by Ramanujan's second approximation."""
        a, b = self.semi_axes_px
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


def ellipse_from_points(points_px: Array) -> Ellipse:
    """Least-squares conic through points that lie on an ellipse, shape (n, 2), n ≥ 5."""
    middle = points_px.mean(axis=0)
    scale = float(np.abs(points_px - middle).max())
    x, y = ((points_px - middle) / scale).T
    design = np.column_stack([x * x, x * y, y * y, x, y])
    a, b, c, d, e = np.linalg.lstsq(design, np.ones(len(x)), rcond=None)[0]
    conic = np.array([[a, b / 2, d / 2], [b / 2, c, e / 2], [d / 2, e / 2, -1.0]])
    return _ellipse_from_conic(conic, middle, scale)


def conic_of_circle(centre: Array, normal: Array, radius: float) -> Array:
    """Image of a circle as a conic on normalised rays, shape (3, 3).

    ``centre`` and unit ``normal`` in the camera's frame. With A = (n·C) I - C nᵀ a ray x lies on
    the cone of the circle when |A x|² = R² (n·x)², hence Q = AᵀA - R² n nᵀ.
    """
    a = float(normal @ centre) * np.eye(3) - np.outer(centre, normal)
    return np.asarray(a.T @ a - radius**2 * np.outer(normal, normal))


def eccentricity(centre: Array, normal: Array, radius: float) -> Array:
    """Centre of the image ellipse minus image of the circle's centre, normalised rays, (2,)."""
    conic = conic_of_circle(centre, normal, radius)
    ellipse_centre = -np.linalg.solve(conic[:2, :2], conic[:2, 2])
    return np.asarray(ellipse_centre - centre[:2] / centre[2])


def _ellipse_from_conic(conic: Array, middle: Array, scale: float) -> Ellipse:
    centre = -np.linalg.solve(conic[:2, :2], conic[:2, 2])
    level = -float(conic[2, 2] + conic[2, :2] @ centre)
    values, vectors = np.linalg.eigh(conic[:2, :2] / level)
    if values[0] <= 0:
        raise ValueError("the points do not lie on an ellipse")
    major = vectors[:, 0]
    return Ellipse(
        middle + scale * centre,
        (float(scale / np.sqrt(values[0])), float(scale / np.sqrt(values[1]))),
        float(np.arctan2(major[1], major[0])),
    )
