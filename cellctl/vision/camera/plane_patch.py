"""A patch of raw pixels seen as points of a plane in front of the camera.

A circle that lies in a parallel plane is a circle in these coordinates: lens distortion and
perspective eccentricity are gone at once.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import distort, undistort
from cellctl.vision.camera.stereo_head import CameraModel

X_AXIS = np.array([1.0, 0.0, 0.0])

_POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
_QUADRATIC = 6
"""Number of leading powers that are enough to express the derivatives of all ten."""


def _terms(u: Array, v: Array) -> Array:
    """The powers at n places, shape (10, n)."""
    uu, vv = u * u, v * v
    return np.stack([np.ones_like(u), u, v, uu, u * v, vv, uu * u, uu * v, u * vv, vv * v])


def _derivative(axis: int) -> Array:
    """Matrix from the coefficients of a cubic to those of its derivative by u or v, (10, 6)."""
    matrix = np.zeros((len(_POWERS), _QUADRATIC))
    for row, powers in enumerate(_POWERS):
        if powers[axis]:
            lower = (powers[0] - (axis == 0), powers[1] - (axis == 1))
            matrix[row, _POWERS.index(lower)] = powers[axis]
    return matrix


_BY_U, _BY_V = _derivative(0), _derivative(1)
# Chebyshev nodes keep the error of the polynomial even over the patch. With equidistant nodes it
# would grow towards the border, where the rim lies.
_LINE: Array = np.cos(np.linspace(0.0, np.pi, 7))
_NODES: Array = np.stack([axis.ravel() for axis in np.meshgrid(_LINE, _LINE)])
_FIT: Array = np.asarray(np.linalg.pinv(_terms(*_NODES).T), dtype=float)


@dataclass(frozen=True, slots=True, eq=False)
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
    """Coefficients of the cubic polynomial from pixels to the plane, shape (10, 2)."""

    unit_px: float
    """Plane units in a pixel, in the middle of the patch."""

    def to_px(self, points: Array) -> Array:
        """Raw pixels, shape (n, 2), of points of the plane, shape (n, 2)."""
        # Units of the distance make the foot of the camera's perpendicular equal to ``normal``, so
        # no length enters: the same map holds for any distance of the plane.
        rays = self.normal + points @ self.basis
        return distort(self.camera, rays[:, :2] / rays[:, 2:])

    def from_px(self, columns: Array, rows: Array) -> tuple[Array, Array]:
        """Points of the plane, shape (2, n), at raw pixels, and their derivatives (2, 2, n)."""
        u = (columns - self.middle_px[0]) / self.half_px
        v = (rows - self.middle_px[1]) / self.half_px
        terms, weights = _terms(u, v), self.coefficients.T
        slopes = np.stack([weights @ _BY_U, weights @ _BY_V], axis=1) / self.half_px
        jacobian = (slopes.reshape(4, _QUADRATIC) @ terms[:_QUADRATIC]).reshape(2, 2, -1)
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
    seen = to_plane(camera, _NODES.T * half_px + middle_px, normal, basis)
    coefficients = _FIT @ seen
    across, down = coefficients[1:3] / half_px
    unit_px = float(np.sqrt(abs(across[0] * down[1] - across[1] * down[0])))
    return PlanePatch(camera, normal, basis, middle_px, half_px, coefficients, unit_px)
