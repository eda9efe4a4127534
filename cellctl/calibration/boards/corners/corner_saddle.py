"""Corners as saddle points of the smoothed grey values (Lucchese and Mitra 2002).

A small window is enough for it, so it serves where something else stands close to a corner. A
refinement by gradients needs longer edges, and takes those of a neighbour for the corner's own.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_ROUNDS, _SETTLED_PX = 10, 1e-3
_MAX_STEP_PX = 1.0
"""Longest step: farther away the quadratic that was fitted says nothing of the image."""


def saddle_points(image: Image, pixels: Array, half: int) -> Array:
    """Saddle points near ``pixels`` (n, 2), shape (n, 2); not a number where there is none.

    The window reaches ``half`` px to each side, and a saddle is not looked for farther away.
    """
    # Smoothed in proportion to the window, so that a parabola describes the greys in all of it.
    blurred = cv2.GaussianBlur(image.astype(np.float32), (0, 0), max(1.0, 0.5 * half))
    smooth = np.asarray(blurred, dtype=np.float32)
    fit = _parabola_fit(half)
    return np.array([_saddle_point(smooth, start, half, fit) for start in pixels]).reshape(-1, 2)


def _parabola_fit(half: int) -> Array:
    """Grey values of a window to the terms x², xy, y², x, y, 1, weighted towards its middle."""
    y, x = (axis.ravel() for axis in np.mgrid[-half : half + 1, -half : half + 1].astype(float))
    root = np.sqrt(np.maximum(half + 1.0 - np.hypot(x, y), 0.0))
    terms = np.stack([x * x, x * y, y * y, x, y, np.ones_like(x)], axis=1)
    return np.asarray(np.linalg.pinv(terms * root[:, None]) * root)


def _saddle_point(smooth: NDArray[np.float32], start: Array, half: int, fit: Array) -> Array:
    place, size = np.array(start, dtype=float), (2 * half + 1, 2 * half + 1)
    for _ in range(_ROUNDS):
        window = cv2.getRectSubPix(smooth, size, (float(place[0]), float(place[1])))
        xx, xy, yy, x, y, _ = fit @ window.ravel()
        if 4.0 * xx * yy >= xy * xy:
            break
        step = -np.linalg.solve([[2.0 * xx, xy], [xy, 2.0 * yy]], [x, y])
        length = float(np.linalg.norm(step))
        place += step * min(1.0, _MAX_STEP_PX / max(length, _SETTLED_PX))
        if np.linalg.norm(place - start) > half:
            break
        if length < _SETTLED_PX:
            return place
    return np.full(2, np.nan)
