"""Refuse images that cannot carry a measurement, each for its own reason."""

import cv2
import numpy as np

from cellctl.errors.vision import (
    ImageBlack,
    ImageBlurred,
    ImageSaturated,
    ImageSizeMismatch,
)
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.stereo_head import StereoHead

_BLACK_GREY = 12
"""An image whose brightest pixels are below this is black: lamp off, cap on the lens."""
_SATURATED_GREY = 254
_SATURATED_SHARE = 0.25
"""Share of saturated pixels from which on an image is refused: what lies beside the part may
saturate."""
_MIN_SPREAD_GREY = 12
"""Least difference between the brightest and the darkest place of an image."""
_STRIDE = 8
"""Every eighth pixel of every eighth row is enough for these statistics; places of so many pixels
show the contrast."""


def check_pair(left: Image, right: Image, head: StereoHead) -> None:
    """Raise the fault that fits when one of the two images cannot be measured."""
    for side, image in (("left", left), ("right", right)):
        check_image(image, head.image_size, side)


def check_image(image: Image, size: tuple[int, int], side: str) -> None:
    """``ImageSizeMismatch``, ``ImageBlack``, ``ImageSaturated`` or ``ImageBlurred``."""
    if image.ndim != 2 or image.dtype != np.uint8:
        raise ImageSizeMismatch(f"{side}: needs one plane of 8 bit grey values")
    width, height = size
    if image.shape != (height, width):
        have = f"{image.shape[1]}×{image.shape[0]}"
        raise ImageSizeMismatch(f"{side}: image is {have}, calibration is {width}×{height}")
    counts = np.bincount(image[::_STRIDE, ::_STRIDE].ravel(), minlength=256)
    share = np.cumsum(counts) / counts.sum()
    # A quantile and not the maximum: a few hot pixels or reflexes would make a black image pass.
    high = int(np.searchsorted(share, 0.998))
    # The order matters: a black or an overexposed image has no contrast either, and the fault must
    # name the cause, because the operator's remedy is another one.
    if high <= _BLACK_GREY:
        raise ImageBlack(f"{side}: brightest grey value is {high}")
    saturated = 1.0 - float(share[_SATURATED_GREY - 1])
    if saturated > _SATURATED_SHARE:
        raise ImageSaturated(f"{side}: {saturated:.0%} of the pixels are at full scale")
    spread = _spread_grey(image)
    if spread < _MIN_SPREAD_GREY:
        raise ImageBlurred(f"{side}: grey values differ by only {spread:.0f}")


def _spread_grey(image: Image) -> float:
    """Brightest less darkest place of the image.

    Places and not shares of it: three holes in an even plate are a thousandth of an image. They
    are averages, in which a hot pixel is lost and the noise of an even image does not count.
    """
    size = (max(image.shape[1] // _STRIDE, 1), max(image.shape[0] // _STRIDE, 1))
    places = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    return float(places.max()) - float(places.min())
