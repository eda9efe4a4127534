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
from cellctl.vision.stereo_head import StereoHead

_BLACK_GREY = 12
_SATURATED_GREY = 254
_SATURATED_SHARE = 0.25
_MIN_SPREAD_GREY = 12.0
_STRIDE = 4


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
    sample = image[::_STRIDE, ::_STRIDE]
    low, high = np.percentile(sample, (0.2, 99.8))
    if high <= _BLACK_GREY:
        raise ImageBlack(f"{side}: brightest grey value is {high:.0f}")
    saturated = float(np.mean(sample >= _SATURATED_GREY))
    if saturated > _SATURATED_SHARE:
        raise ImageSaturated(f"{side}: {saturated:.0%} of the pixels are at full scale")
    if high - low < _MIN_SPREAD_GREY:
        raise ImageBlurred(f"{side}: grey values differ by only {high - low:.0f}")


def edge_width_px(image: Image) -> float:
    """Typical width (standard deviation) of the sharpest edges, from contrast over slope."""
    small = cv2.GaussianBlur(image, (0, 0), 0.7).astype(np.float32)
    gx, gy = (
        cv2.Sobel(small, cv2.CV_32F, 1, 0, scale=0.125),
        cv2.Sobel(small, cv2.CV_32F, 0, 1, scale=0.125),
    )
    slope = float(np.percentile(cv2.magnitude(gx, gy), 99.95))
    low, high = np.percentile(image[::_STRIDE, ::_STRIDE], (0.5, 99.5))
    return float(high - low) / max(slope, 1e-3) / float(np.sqrt(2.0 * np.pi))
