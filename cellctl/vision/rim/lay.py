"""The lay of a machined face: strokes of its tool, which run on beside a rim.

A stroke along the rim shifts its edge and leaves no misfit there. It does not end at the rim,
though: seen beside it, it tells how much it adds at it. To the fit of a rim strokes are noise that
is correlated along the lay (ISO 21920-1) and not across it.
"""

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.plane_patch import PlanePatch
from cellctl.vision.rim.robust import median

_REACH_PX = 14.0
"""How far beyond the rim the face is looked at."""
_ANISOTROPY = 0.2
"""From this share of directed gradients on there is a lay; noise alone stays below a tenth."""
_CLIP = 3.0
_ALONG = 0.3
"""Change of a stroke over one radius, of its own height."""


def lay_across(image: Image, patch: PlanePatch, middle_px: Array, clear_px: float) -> Array | None:
    """Unit vector across the lay in the plane, shape (2,); None where the face has no lay.

    Looks at the ring from ``clear_px`` to a little more round a hole: the structure tensor of its
    grey values, with strong edges clipped.
    """
    reach = clear_px + _REACH_PX
    x0, y0 = np.maximum(np.floor(middle_px - reach).astype(int), 0)
    x1, y1 = np.ceil(middle_px + reach).astype(int) + 1
    cut = cv2.GaussianBlur(image[y0:y1, x0:x1].astype(np.float32), (0, 0), 0.8)
    rows, columns = np.indices(cut.shape)
    distance = np.hypot(columns + x0 - middle_px[0], rows + y0 - middle_px[1])
    ring = (distance > clear_px) & (distance < reach)
    gradient = np.stack(
        [cv2.Sobel(cut, cv2.CV_32F, 1, 0)[ring], cv2.Sobel(cut, cv2.CV_32F, 0, 1)[ring]]
    ).astype(float)
    gradient -= gradient.mean(axis=1, keepdims=True)
    size = np.hypot(*gradient)
    limit = _CLIP * max(median(size), 1e-3)
    gradient *= np.minimum(1.0, limit / np.maximum(size, 1e-9))
    _, jacobian = patch.from_px(middle_px[:1], middle_px[1:])
    in_plane = np.linalg.solve(jacobian[:, :, 0].T * (1.0 / patch.unit_px), gradient)
    values, vectors = np.linalg.eigh(in_plane @ in_plane.T)
    if values[1] - values[0] < _ANISOTROPY * values.sum():
        return None
    return np.asarray(vectors[:, 1])


def strokes(offsets_px: Array, across: Array, radius_px: float) -> Array:
    """Strokes a pixel wide that change slowly along the lay, shape (2 k, n).

    ``offsets_px`` (2, n) lie in the plane, from the centre of the rim.
    """
    position = across @ offsets_px
    along = np.array([-across[1], across[0]]) @ offsets_px / radius_px
    knots = np.arange(np.floor(position.min()), np.ceil(position.max()) + 1.0)
    heights = np.maximum(1.0 - np.abs(position - knots[:, None]), 0.0)
    return np.concatenate([heights, _ALONG * along * heights])
