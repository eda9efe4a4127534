"""The lens of one camera: forward by formula, backward by Newton's method."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from fakes.world.scene import LensTruth, MonoTruth, Side, StereoTruth

Array = NDArray[np.float64]

_NEWTON_STEPS: Final = 12
_NEWTON_TOLERANCE: Final = 1e-13
_MISFIT_RATE: Final = 2 * np.pi / 0.3
"""Two to three waves over the picture, as the rings of a real lens leave them."""


@dataclass(frozen=True, slots=True)
class View:
    """One camera, with its place in the head; a single camera is its own head."""

    side: Side
    lens: LensTruth
    size_px: tuple[int, int]
    """Width, height."""
    view_T_head: RigidTransform
    """The head frame is the left camera."""


def views_of(optics: StereoTruth | MonoTruth) -> tuple[View, ...]:
    """Left and right camera of a head, or the one camera that there is."""
    if isinstance(optics, StereoTruth):
        return views(optics)
    return (View("left", optics.lens, optics.image_size_px, RigidTransform.identity()),)


def views(stereo: StereoTruth) -> tuple[View, View]:
    """Left and right camera of a head."""
    left = View("left", stereo.left, stereo.image_size_px, RigidTransform.identity())
    right = View("right", stereo.right, stereo.image_size_px, stereo.right_T_left)
    return left, right


def project(lens: LensTruth, points_m: Array) -> Array:
    """Pixels of points given in the camera, shape (N, 3) to (N, 2)."""
    xn = points_m[:, 0] / points_m[:, 2]
    yn = points_m[:, 1] / points_m[:, 2]
    xd, yd = distort(lens, xn, yn)
    return np.column_stack(
        [lens.focal_px[0] * xd + lens.centre_px[0], lens.focal_px[1] * yd + lens.centre_px[1]]
    )


def distort(lens: LensTruth, xn: Array, yn: Array) -> tuple[Array, Array]:
    """Distorted from ideal normalised coordinates: k1, k2, p1, p2, k3."""
    k1, k2, p1, p2, k3 = lens.distortion
    r2 = xn * xn + yn * yn
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    xd = xn * radial + 2 * p1 * xn * yn + p2 * (r2 + 2 * xn * xn)
    yd = yn * radial + p1 * (r2 + 2 * yn * yn) + 2 * p2 * xn * yn
    amplitude, phase_x, phase_y = lens.misfit
    if amplitude:
        along, down = _MISFIT_RATE * xn + phase_x, _MISFIT_RATE * yn + phase_y
        xd = xd + amplitude * np.sin(along) * np.cos(down)
        yd = yd + amplitude * np.cos(along) * np.sin(down)
    return xd, yd


def undistort(lens: LensTruth, pixels: Array) -> Array:
    """Ideal normalised coordinates of pixels, shape (N, 2) to (N, 2)."""
    xd = (pixels[:, 0] - lens.centre_px[0]) / lens.focal_px[0]
    yd = (pixels[:, 1] - lens.centre_px[1]) / lens.focal_px[1]
    xn, yn = xd.copy(), yd.copy()
    for _ in range(_NEWTON_STEPS):
        fx, fy = distort(lens, xn, yn)
        ex, ey = xd - fx, yd - fy
        jxx, jxy, jyy = _jacobian(lens, xn, yn)
        determinant = jxx * jyy - jxy * jxy
        xn = xn + (jyy * ex - jxy * ey) / determinant
        yn = yn + (jxx * ey - jxy * ex) / determinant
        if max(np.abs(ex).max(), np.abs(ey).max()) < _NEWTON_TOLERANCE:
            return np.column_stack([xn, yn])
    # A drawn lens can have a distortion that folds the image. A picture through it would be wrong
    # without anybody noticing.
    raise ValueError("the lens model cannot be inverted over the whole image")


def _jacobian(lens: LensTruth, xn: Array, yn: Array) -> tuple[Array, Array, Array]:
    """d(distorted)/d(ideal) without the misfit, which is too small to matter for the search of the
    inverse; symmetric in this model."""
    k1, k2, p1, p2, k3 = lens.distortion
    r2 = xn * xn + yn * yn
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2 * (k1 + r2 * (2 * k2 + 3 * k3 * r2))
    jxx = radial + slope * xn * xn + 2 * p1 * yn + 6 * p2 * xn
    jyy = radial + slope * yn * yn + 6 * p1 * yn + 2 * p2 * xn
    jxy = slope * xn * yn + 2 * p1 * xn + 2 * p2 * yn
    return jxx, jxy, jyy
