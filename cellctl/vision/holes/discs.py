"""Candidates for bright discs: even areas whose outline is an ellipse.

A large disc that is seen askew is no circle: its edges scatter their votes (``candidates``) over
more places than count as one. Its area says where it is, whatever the angle.
"""

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.holes.candidates import Candidate, find_candidates

_SMALLEST_PX = 6.0
"""Radius below which pixels decide the shape of an area, and circles are close to their ellipse."""
_NARROWEST = 0.7
"""Short over long axis of an ellipse: a line of sight 45° off the normal of the disc."""
_AS_ELLIPSE = 0.015
"""Relative difference between an area and that of the ellipse of the same second moments: 0.012
for a disc that has lost a tenth, 0.038 under a scratch of 3 % of its area, 0.047 for a square."""


def bright_discs(image: Image, radii_px: tuple[float, float]) -> list[Candidate]:
    """Areas brighter than what is around them, by Otsu's threshold, and everything round that votes
    find elsewhere."""
    areas = _elliptic_areas(image, radii_px)
    voted = find_candidates(image, radii_px, bright=True)
    return areas + [one for one in voted if not any(_within(one, area) for area in areas)]


def _within(one: Candidate, area: Candidate) -> bool:
    return bool(np.linalg.norm(one.centre_px - area.centre_px) < area.radius_px / 2)


def _elliptic_areas(image: Image, radii_px: tuple[float, float]) -> list[Candidate]:
    soft = cv2.GaussianBlur(image, (0, 0), 1.0)
    _, bright = cv2.threshold(soft, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    _, labels, boxes, _ = cv2.connectedComponentsWithStats(bright, connectivity=4)
    found = [
        _elliptic_area(labels, label, box, radii_px)
        for label, box in enumerate(boxes)
        if label > 0 and _may_be(box, radii_px, image.shape)
    ]
    return [one for one in found if one is not None]


def _may_be(box: Sequence[int], radii_px: tuple[float, float], shape: tuple[int, ...]) -> bool:
    """Whether a box (x, y, width, height, area) is that of a disc that lies whole in the image."""
    x, y, width, height, area = (int(value) for value in box)
    # The area of an ellipse is that of a circle whose radius is the mean of its axes.
    radius_px = float(np.sqrt(area / np.pi))
    smallest_px = max(radii_px[0] * np.sqrt(_NARROWEST), _SMALLEST_PX)
    whole = x > 0 and y > 0 and x + width < shape[1] and y + height < shape[0]
    return whole and smallest_px < radius_px < radii_px[1]


def _elliptic_area(
    labels: NDArray[Any], label: int, box: Sequence[int], radii_px: tuple[float, float]
) -> Candidate | None:
    x, y, width, height, area = (int(value) for value in box)
    rows, columns = np.nonzero(labels[y : y + height, x : x + width] == label)
    spread = np.cov(np.vstack([columns, rows]), bias=True)
    short_px, long_px = 2.0 * np.sqrt(np.linalg.eigvalsh(spread))
    if abs(np.pi * short_px * long_px / area - 1.0) > _AS_ELLIPSE:
        return None
    # What a circle of the drawing becomes is as long as its diameter, and shorter across.
    if short_px < _NARROWEST * long_px or not radii_px[0] < long_px < radii_px[1]:
        return None
    centre = np.array([columns.mean() + x, rows.mean() + y])
    return Candidate(centre, float(long_px), 1.0)
