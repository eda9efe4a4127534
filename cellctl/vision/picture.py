"""Pictures of a measurement: the measured rims, drawn into the image."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement, Side

Picture = NDArray[np.uint8]

_GREEN, _YELLOW, _BLACK = (60, 220, 60), (0, 220, 255), (0, 0, 0)
# OpenCV draws with fixed-point coordinates: five bits show a 32nd of a pixel. Whole pixels would
# hide what is measured here.
_SHIFT = 5
INSET_PX = 360
"""Side of the magnified view of a hole."""
_INSET_ZOOM_SPAN = 1.5


def annotate(image: Image, measurement: PairMeasurement, side: Side) -> Picture:
    """Fitted ellipses, centres and names on the image; below it each hole magnified.

    Shape (height + ``INSET_PX``, width, 3): nothing lies over what was measured.
    """
    picture = _coloured(image)
    for hole in measurement.holes:
        ellipse, centre = _of(hole, side)
        _draw_ellipse(picture, ellipse, 1.0, np.zeros(2), 2)
        _cross(picture, centre, 12)
        corner = centre + np.array([1.0, -1.0]) * (ellipse.semi_axes_px[0] + 12)
        _label(picture, f"{hole.name} {hole.diameter_m / MM:.2f}", corner, 1.1)
    strip = _insets(image, measurement, side)
    return np.asarray(np.vstack([picture, strip]), dtype=np.uint8)


def _coloured(image: cv2.typing.MatLike) -> Picture:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), dtype=np.uint8)


def _of(hole: HoleMeasurement, side: Side) -> tuple[Ellipse, Array]:
    if side == "left":
        return hole.left_ellipse, hole.left_px
    return hole.right_ellipse, hole.right_px


def _insets(image: Image, measurement: PairMeasurement, side: Side) -> Picture:
    """A strip of magnified holes, with the ellipse one pixel thin; as many as the width takes."""
    height, width = image.shape
    strip: Picture = np.zeros((INSET_PX, width, 3), np.uint8)
    for index, hole in enumerate(measurement.holes):
        left = index * (INSET_PX + 8)
        if left + INSET_PX > width:
            break
        ellipse, centre = _of(hole, side)
        half = int(np.ceil(ellipse.semi_axes_px[0] * _INSET_ZOOM_SPAN)) + 2
        x0, y0 = (int(value) - half for value in np.rint(centre))
        if x0 < 0 or y0 < 0 or x0 + 2 * half + 1 > width or y0 + 2 * half + 1 > height:
            continue
        cut = image[y0 : y0 + 2 * half + 1, x0 : x0 + 2 * half + 1]
        zoom = INSET_PX / cut.shape[0]
        inset = _coloured(cv2.resize(cut, (INSET_PX, INSET_PX), interpolation=cv2.INTER_NEAREST))
        # Nearest-neighbour zoom puts the middle of pixel (0, 0) at (zoom - 1) / 2.
        offset = np.array([x0, y0]) - (zoom - 1.0) / (2.0 * zoom)
        _draw_ellipse(inset, ellipse, zoom, offset, 1)
        _cross(inset, (centre - offset) * zoom, 8)
        _label(inset, hole.name, np.array([8.0, 26.0]), 0.8)
        strip[:, left : left + INSET_PX] = inset
    return strip


def _draw_ellipse(
    picture: Picture, ellipse: Ellipse, zoom: float, offset: Array, thickness: int
) -> None:
    points = (ellipse.points(120) - offset) * zoom
    fixed = np.rint(points * (1 << _SHIFT)).astype(np.int32)
    cv2.polylines(
        picture,
        [fixed[:, None]],
        isClosed=True,
        color=_GREEN,
        thickness=thickness,
        lineType=cv2.LINE_AA,
        shift=_SHIFT,
    )


def _cross(picture: Picture, centre: Array, size: int) -> None:
    x, y = np.rint(centre * (1 << _SHIFT)).astype(int)
    arm = size << _SHIFT
    for start, end in (((x - arm, y), (x + arm, y)), ((x, y - arm), (x, y + arm))):
        cv2.line(
            picture,
            (int(start[0]), int(start[1])),
            (int(end[0]), int(end[1])),
            _YELLOW,
            1,
            cv2.LINE_AA,
            _SHIFT,
        )


def _label(picture: Picture, text: str, corner: Array, scale: float) -> None:
    place = (int(corner[0]), int(corner[1]))
    font = cv2.FONT_HERSHEY_SIMPLEX
    cv2.putText(picture, text, place, font, scale, _BLACK, 6, cv2.LINE_AA)
    cv2.putText(picture, text, place, font, scale, _YELLOW, 2, cv2.LINE_AA)
