"""The image with every contact drawn in, as PNG."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.errors.vision import ImageFileInvalid
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.vision.measurement import (
    ConnectorMeasurement,
    ContactState,
)

_COLOURS: dict[ContactState, tuple[int, int, int]] = {
    "ok": (80, 200, 80),
    "missing": (60, 60, 230),
    "bent": (0, 140, 255),
    "hidden": (0, 220, 220),
}
"""Blue, green, red."""
_MARK = (230, 160, 60)
_ENLARGED = 3
_MARGIN_PX = 60
_SHIFT = 4


def picture_of(image: Image, result: ConnectorMeasurement) -> bytes:
    """The connector enlarged with a circle by state on every contact.

    Marks of the gripper lie outside of it; the whole image stands beside it, with them.
    """
    places = np.array([contact.px for contact in result.contacts])
    low = np.maximum(np.floor(places.min(axis=0)).astype(int) - _MARGIN_PX, 0)
    high = np.ceil(places.max(axis=0)).astype(int) + _MARGIN_PX
    cut = image[low[1] : high[1], low[0] : high[0]]
    large = cv2.resize(cut, None, fx=_ENLARGED, fy=_ENLARGED, interpolation=cv2.INTER_NEAREST)
    # Contacts are often dark; what an engineer wants to see are their borders.
    large = cv2.normalize(large, np.empty_like(large), 0, 255, cv2.NORM_MINMAX)
    canvas = np.asarray(cv2.cvtColor(large, cv2.COLOR_GRAY2BGR), dtype=np.uint8)
    for contact in result.contacts:
        place = (contact.px - low + 0.5) * _ENLARGED - 0.5
        radius = result.radius_px * _ENLARGED
        _circle(canvas, place, radius, _COLOURS[contact.state])
        label = contact.name if contact.state == "ok" else f"{contact.name} {contact.state}"
        _text(canvas, place - radius * np.array([0.4, 1.3]), label, _COLOURS[contact.state])
    whole = _with_marks(image, result, canvas.shape[0])
    done, data = cv2.imencode(".png", np.hstack([whole, canvas]))
    if not done:
        raise ImageFileInvalid("the picture could not be encoded as PNG")
    return data.tobytes()


def _with_marks(image: Image, result: ConnectorMeasurement, height: int) -> NDArray[np.uint8]:
    """The whole image at this height, with the marks."""
    scale = height / image.shape[0]
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    small = cv2.resize(small, (small.shape[1], height))
    whole = np.asarray(cv2.cvtColor(small, cv2.COLOR_GRAY2BGR), dtype=np.uint8)
    if result.marks is not None:
        for px in result.marks.px:
            _circle(whole, (px + 0.5) * scale - 0.5, result.marks.radius_px * scale, _MARK)
    return whole


def _circle(
    canvas: NDArray[np.uint8], place: np.ndarray, radius: float, colour: tuple[int, int, int]
) -> None:
    x, y = (round(float(value) * 2**_SHIFT) for value in place)
    size = round(radius * 2**_SHIFT)
    cv2.circle(canvas, (x, y), size, colour, 1, cv2.LINE_AA, _SHIFT)


def _text(
    canvas: NDArray[np.uint8], place: np.ndarray, words: str, colour: tuple[int, int, int]
) -> None:
    x, y = (round(float(value)) for value in place)
    cv2.putText(canvas, words, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv2.LINE_AA)
