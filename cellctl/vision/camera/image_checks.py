"""Refuse images that cannot carry a measurement, each for its own reason."""

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
_SATURATED_GREY = 254
_SATURATED_SHARE = 0.25
_MIN_SPREAD_GREY = 12
_STRIDE = 8
"""Every eighth pixel of every eighth row is enough for these statistics."""


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
    # Quantiles instead of extremes: a few hot pixels or reflexes would make a black image pass.
    low, high = (int(np.searchsorted(share, part)) for part in (0.002, 0.998))
    # The order matters: a black or an overexposed image has no contrast either, and the fault must
    # name the cause, because the operator's remedy is another one.
    if high <= _BLACK_GREY:
        raise ImageBlack(f"{side}: brightest grey value is {high}")
    saturated = 1.0 - float(share[_SATURATED_GREY - 1])
    if saturated > _SATURATED_SHARE:
        raise ImageSaturated(f"{side}: {saturated:.0%} of the pixels are at full scale")
    if high - low < _MIN_SPREAD_GREY:
        raise ImageBlurred(f"{side}: grey values differ by only {high - low}")
