"""A patch of raw pixels seen as points of a plane in front of the camera.

A circle that lies in a parallel plane is a circle in these coordinates: lens distortion and
perspective eccentricity are gone at once.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera import distort, undistort
from cellctl.vision.stereo_head import CameraModel

X_AXIS = np.array([1.0, 0.0, 0.0])

_NODES = 7
_POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))


@dataclass(frozen=True, slots=True)
class PlanePatch:
    """The plane ``normal · P = 1`` with ``normal`` pointing away from the camera.

    Its points are in units of the camera's distance from it.
    """

    camera: CameraModel
    normal: Array
    """Shape (3,)."""
    basis: Array
    """Shape (2, 3): the plane's axes in the frame of the camera."""
    middle_px: Array
    half_px: float
    """The patch is the square of twice this side round ``middle_px``."""
    coefficients: Array
    """Of the cubic polynomial from pixels to the plane, shape (10, 2)."""

    @property
    def unit_px(self) -> float:
        """Plane units in a pixel, in the middle of the patch."""
        linear = self.coefficients[1:3] / self.half_px
        return float(np.sqrt(abs(np.linalg.det(linear))))

    def to_px(self, points: Array) -> Array:
        """Raw pixels, shape (n, 2), of points of the plane, shape (n, 2)."""
        rays = self.normal + points @ self.basis
        return distort(self.camera, rays[:, :2] / rays[:, 2:])

    def from_px(self, columns: Array, rows: Array) -> tuple[Array, Array]:
        """Points of the plane, shape (2, n), at raw pixels, and their derivatives (2, 2, n)."""
        u = (columns - self.middle_px[0]) / self.half_px
        v = (rows - self.middle_px[1]) / self.half_px
        powers_u, powers_v = _powers(u), _powers(v)
        terms = np.stack([powers_u[i] * powers_v[j] for i, j in _POWERS])
        flat = np.zeros_like(u)
        by_u = np.stack([i * powers_u[i - 1] * powers_v[j] if i else flat for i, j in _POWERS])
        by_v = np.stack([j * powers_u[i] * powers_v[j - 1] if j else flat for i, j in _POWERS])
        weights = self.coefficients.T
        jacobian = np.stack([weights @ by_u, weights @ by_v], axis=1) / self.half_px
        return weights @ terms, jacobian

    def px_by_point(self, point: Array) -> Array:
        """Derivative of the raw pixel by the plane's coordinates at a point, shape (2, 2)."""
        step = 0.5 * self.unit_px
        probe = point + step * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        sides = self.to_px(probe)
        return np.column_stack([sides[0] - sides[1], sides[2] - sides[3]]) / (2.0 * step)


def plane_basis(normal: Array, across: Array = X_AXIS) -> Array:
    """Two axes of the plane, shape (2, 3), the first along ``across`` where possible."""
    first = across - float(across @ normal) * normal
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


def to_plane(camera: CameraModel, pixels: Array, normal: Array, basis: Array) -> Array:
    """Points of the plane, shape (n, 2), seen at raw pixels, shape (n, 2)."""
    rays = np.column_stack([undistort(camera, pixels), np.ones(len(pixels))])
    return np.asarray((rays @ basis.T) / (rays @ normal)[:, None])


def plane_patch(
    camera: CameraModel, normal: Array, basis: Array, middle_px: Array, half_px: float
) -> PlanePatch:
    """The plane as seen by the pixels round ``middle_px``.

    The map is smooth: it is computed on a few nodes and carried to the pixels by a cubic
    polynomial, which is exact to better than 1e-5 px over the size of a hole.
    """
    nodes = np.cos(np.linspace(0.0, np.pi, _NODES))
    u, v = (axis.ravel() for axis in np.meshgrid(nodes, nodes))
    powers_u, powers_v = _powers(u), _powers(v)
    terms = np.stack([powers_u[i] * powers_v[j] for i, j in _POWERS])
    seen = to_plane(camera, np.column_stack([u, v]) * half_px + middle_px, normal, basis)
    coefficients = np.asarray(np.linalg.lstsq(terms.T, seen, rcond=None)[0], dtype=float)
    return PlanePatch(camera, normal, basis, middle_px, half_px, coefficients)


def _powers(values: Array) -> tuple[Array, Array, Array, Array]:
    square = values * values
    return np.ones_like(values), values, square, square * values
