"""Analytic edge positions by OpenCV's own projection, and those of a rendered picture.

In a row of pixels that crosses an edge once, the sum of the coverage is exactly the mean position
of the edge over the height of the row. Both sides are compared by that mean.
"""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.render.optics.lens import View
from fakes.world.scene import LensTruth

Array = NDArray[np.float64]


def random_view(rng: np.random.Generator, size_px: tuple[int, int], target_px: Array) -> View:
    """A camera whose image is a small part of a 2448 × 2048 field; ``target_px`` its middle."""
    offset = target_px - np.array(size_px) / 2
    distortion = (
        rng.uniform(-0.25, 0.1),
        rng.uniform(-0.2, 0.3),
        rng.uniform(-1e-3, 1e-3),
        rng.uniform(-1e-3, 1e-3),
        rng.uniform(-0.1, 0.1),
    )
    lens = LensTruth(
        focal_px=(float(rng.uniform(3000, 4000)), float(rng.uniform(3000, 4000))),
        centre_px=(float(1224 - offset[0]), float(995 - offset[1])),
        distortion=distortion,
        blur_px=0.0,
        gain=1.0,
    )
    head_turn = Rotation.from_euler("xyz", rng.uniform(-10, 10, 3), degrees=True)
    view_T_head = RigidTransform.from_components(rng.uniform(-0.05, 0.05, 3), head_turn)
    return View("right", lens, size_px, view_T_head)


def pose_at(rng: np.random.Generator, view: View, tilt_deg: float) -> RigidTransform:
    """Pose in the head of an object whose origin lies near the middle of the image."""
    direction = np.array(
        [
            (view.size_px[0] / 2 - view.lens.centre_px[0]) / view.lens.focal_px[0],
            (view.size_px[1] / 2 - view.lens.centre_px[1]) / view.lens.focal_px[1],
            1.0,
        ]
    )
    tilt = Rotation.from_rotvec(rng.normal(0, np.radians(tilt_deg) / 2, 3))
    spin = Rotation.from_euler("z", rng.uniform(0, 2 * np.pi))
    facing = tilt * Rotation.from_euler("x", 180, degrees=True) * spin
    distance_m = rng.uniform(0.45, 0.6)
    view_T_object = RigidTransform.from_components(direction * distance_m, facing)
    return view.view_T_head.inv() * view_T_object


def project_cv(view: View, head_T_object: RigidTransform, points_m: Array) -> Array:
    """Pixels by ``cv2.projectPoints``, which shares no code with the renderer."""
    pose = view.view_T_head * head_T_object
    lens = view.lens
    matrix = np.array(
        [
            [lens.focal_px[0], 0, lens.centre_px[0]],
            [0, lens.focal_px[1], lens.centre_px[1]],
            [0, 0, 1.0],
        ]
    )
    pixels, _ = cv2.projectPoints(
        points_m, pose.rotation.as_rotvec(), pose.translation, matrix, np.array(lens.distortion)
    )
    return np.asarray(pixels[:, 0, :], dtype=np.float64)


def mean_in_strips(curve: Array, strips: NDArray[np.int_]) -> Array:
    """Mean x over y in [k - 0.5, k + 0.5] of a curve (N, 2) that is a function of y."""
    order = np.argsort(curve[:, 1])
    x, y = curve[order, 0], curve[order, 1]
    area = np.concatenate([[0.0], np.cumsum(np.diff(y) * (x[1:] + x[:-1]) / 2)])
    return np.asarray(np.interp(strips + 0.5, y, area) - np.interp(strips - 0.5, y, area))


def inner_strips(curve: Array, margin: float = 0.0) -> NDArray[np.int_]:
    """Rows that a curve crosses over their whole height."""
    low, high = curve[:, 1].min() + margin, curve[:, 1].max() - margin
    return np.arange(int(np.ceil(low + 0.5)), int(np.floor(high - 0.5)) + 1)


def with_blur(view: View, blur_px: float) -> View:
    """The same camera out of perfect focus."""
    return replace(view, lens=replace(view.lens, blur_px=blur_px))
