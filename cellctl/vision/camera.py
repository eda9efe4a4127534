"""Projection of one camera: rays to raw pixels and back."""

from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.stereo_head import CameraModel

X_AXIS = np.array([1.0, 0.0, 0.0])
_UNDISTORT_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-12)


def project(camera: CameraModel, points: Array) -> Array:
    """Raw pixels, shape (n, 2), of points, shape (n, 3), in the frame of the camera."""
    return distort(camera, points[:, :2] / points[:, 2:])


def distort(camera: CameraModel, rays: Array) -> Array:
    """Raw pixels, shape (n, 2), of undistorted rays x/z, y/z, shape (n, 2)."""
    k1, k2, p1, p2, k3 = camera.distortion
    x, y = rays[:, 0], rays[:, 1]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    bent = np.column_stack(
        [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    )
    return bent @ camera.camera_matrix[:2, :2].T + camera.camera_matrix[:2, 2]


def undistort(camera: CameraModel, pixels: Array) -> Array:
    """Undistorted rays x/z, y/z, shape (n, 2), of raw pixels, shape (n, 2)."""
    points = np.ascontiguousarray(pixels, dtype=float).reshape(-1, 1, 2)
    rays = cv2.undistortPoints(
        points, camera.camera_matrix, camera.distortion, criteria=_UNDISTORT_CRITERIA
    )
    return np.asarray(rays, dtype=float).reshape(-1, 2)


def distort_jacobian(camera: CameraModel, ray: Array) -> Array:
    """Derivative of ``distort`` at one ray, shape (2, 2), px."""
    step = 1e-6
    offsets = np.array([[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]])
    pixels = distort(camera, np.asarray(ray) + offsets)
    return np.column_stack([pixels[0] - pixels[1], pixels[2] - pixels[3]]) / (2.0 * step)


def undistort_covariance(camera: CameraModel, ray: Array, covariance_px2: Array) -> Array:
    """Covariance of a ray, shape (2, 2), from that of its raw pixel."""
    inverse = np.linalg.inv(distort_jacobian(camera, ray))
    return inverse @ covariance_px2 @ inverse.T


@dataclass(frozen=True, slots=True)
class PlanePatch:
    """A patch of raw pixels seen as points of a plane in front of the camera.

    The plane is ``normal · P = 1`` with ``normal`` pointing away from the camera, so its points
    are in units of the camera's distance from it. A circle that lies in a parallel plane is a
    circle in these coordinates, which removes lens distortion and perspective eccentricity at once.
    """

    origin_px: tuple[int, int]
    """Column and row of the patch's first pixel in the image."""
    shape_px: tuple[int, int]
    """Height, width."""
    points: Array
    """Of the pixels row by row, shape (2, height · width)."""
    jacobian: Array
    """Derivative of ``points`` by the pixel's column and row, shape (2, 2, height · width)."""
    basis: Array
    """Shape (2, 3): the plane's axes in the frame of the camera."""
    normal: Array
    """Shape (3,)."""

    @property
    def unit_px(self) -> float:
        """Plane units in a pixel, in the middle of the patch."""
        middle = self.jacobian[:, :, self.jacobian.shape[2] // 2]
        return float(np.sqrt(abs(np.linalg.det(middle))))

    def ray(self, point: Array) -> Array:
        """Direction in the camera's frame, shape (3,), of a point of the plane, shape (2,)."""
        direction: Array = self.normal + point @ self.basis
        return direction


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
    camera: CameraModel,
    normal: Array,
    basis: Array,
    origin_px: tuple[int, int],
    size_px: tuple[int, int],
) -> PlanePatch:
    """Map a patch of ``size_px`` = (width, height) pixels to the plane.

    The map is smooth: it is computed on a coarse grid and carried to the pixels by a cubic
    polynomial, which is exact to better than 1e-5 px over the size of a hole.
    """
    width, height = size_px
    nodes = np.cos(np.linspace(0.0, np.pi, 7))
    u, v = (axis.ravel() for axis in np.meshgrid(nodes, nodes))
    half = np.array([max(width - 1, 1), max(height - 1, 1)]) / 2.0
    pixels = np.column_stack([u, v]) * half + (np.array(origin_px) + half)
    seen = to_plane(camera, pixels, normal, basis)
    coefficients = np.linalg.lstsq(_cubic(u, v).T, seen, rcond=None)[0]
    grid_u, grid_v = np.meshgrid(np.linspace(-1.0, 1.0, width), np.linspace(-1.0, 1.0, height))
    by_u, by_v = _cubic_derivatives(grid_u.ravel(), grid_v.ravel())
    points = coefficients.T @ _cubic(grid_u.ravel(), grid_v.ravel())
    jacobian = np.stack([coefficients.T @ by_u / half[0], coefficients.T @ by_v / half[1]], axis=1)
    return PlanePatch(origin_px, (height, width), points, jacobian, basis, normal)


def _cubic(u: Array, v: Array) -> Array:
    one = np.ones_like(u)
    return np.stack([one, u, v, u * u, u * v, v * v, u**3, u * u * v, u * v * v, v**3])


def _cubic_derivatives(u: Array, v: Array) -> tuple[Array, Array]:
    one, zero = np.ones_like(u), np.zeros_like(u)
    by_u = [zero, one, zero, 2 * u, v, zero, 3 * u * u, 2 * u * v, v * v, zero]
    by_v = [zero, zero, one, zero, u, 2 * v, zero, u * u, 2 * u * v, 3 * v * v]
    return np.stack(by_u), np.stack(by_v)
