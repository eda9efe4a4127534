"""The rectangular face of a plate or board, and the sides that one sees past its edges."""

from typing import Final

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.canvas import Image
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import to_pixels

_SHIFT: Final = 4
"""Fractional bits of OpenCV's drawing functions."""


def draw_face(
    image: Image,
    x_m: Array | Image,
    y_m: Array | Image,
    size_m: tuple[float, float],
    grey: Image | float,
) -> None:
    """Lay a rectangle, centred at the origin of its coordinates, over ``image``."""
    inside = _inside(x_m, size_m[0] / 2) * _inside(y_m, size_m[1] / 2)
    image += inside * (grey - image)


def draw_sides(
    view: View,
    image: Image,
    *,
    pose: RigidTransform,
    size_m: tuple[float, float],
    thickness_m: float,
    grey: float,
    seen_m: tuple[Array, Array],
) -> None:
    """Fill the outline of a plate of some thickness; its face is laid over it afterwards.

    ``seen_m`` are the least and greatest face coordinates in the image: points far outside of it
    do not go through the lens model.
    """
    margin = 0.02
    low = np.maximum(-np.array(size_m) / 2, seen_m[0] - margin)
    high = np.minimum(np.array(size_m) / 2, seen_m[1] + margin)
    if (low >= high).any():
        return
    side = np.linspace(0, 1, 33)
    zero, one = np.zeros(33), np.ones(33)
    unit = np.concatenate(
        [
            np.column_stack([side, zero]),
            np.column_stack([one, side]),
            np.column_stack([side[::-1], one]),
            np.column_stack([zero, side[::-1]]),
        ]
    )
    outline = low + unit * (high - low)
    points = np.concatenate(
        [np.column_stack([outline, np.full(len(outline), -z)]) for z in (0.0, thickness_m)]
    )
    # The outlines of the face and of the bottom together: their convex hull is what a plate of some
    # thickness covers.
    pixels = to_pixels(view, pose, points).astype(np.float32)
    hull = cv2.convexHull(pixels)
    mask = np.zeros(image.shape, np.uint8)
    cv2.fillConvexPoly(mask, np.rint(hull * 2**_SHIFT).astype(np.int32), 255, cv2.LINE_AA, _SHIFT)
    image += mask * np.float32(1 / 255) * (np.float32(grey) - image)


def _inside(coordinate: Array | Image, half_m: float) -> Image:
    """Share of each pixel within ±``half_m``, to first order along the steeper image axis."""
    rows, columns = (size // 2 for size in coordinate.shape)
    # The size of a pixel is taken in the middle of the image for all of it: outlines of plates are
    # only looked at, never measured.
    near = coordinate[rows : rows + 2, columns : columns + 2]
    pixel_m = np.float32(np.hypot(near[0, 1] - near[0, 0], near[1, 0] - near[0, 0]))
    distance = np.abs(coordinate).astype(np.float32, copy=False)
    np.subtract(np.float32(half_m), distance, out=distance)
    distance /= pixel_m
    distance += np.float32(0.5)
    return np.asarray(np.clip(distance, 0, 1, out=distance))
