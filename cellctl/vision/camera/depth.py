"""Grey values of deep cameras in the eight bits that everything here measures."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image


def eight_bits(pixels: NDArray[np.uint16], bits: int) -> Image:
    """The upper eight of the ``bits`` low bits of each sample; raises ``ValueError`` below 8.

    The thresholds of the search and the noise model of the rims are in grey values of 8 bit. The
    bits below them hold mostly noise.
    """
    if bits < 8:
        raise ValueError(f"a sample of {bits} bits has no eight")
    return np.asarray(pixels >> (bits - 8), dtype=np.uint8)


def eight_bit_grey(
    pixels: NDArray[Any], pixel_format: PixelFormat, exposure: ExposureRecord | None
) -> Image:
    """An image of any format in grey, shape (height, width).

    A deep image holds 16 bits unless its exposure record says how many.
    """
    if pixel_format in (PixelFormat.RGB8, PixelFormat.RGB16):
        pixels = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY)
    if pixel_format in (PixelFormat.MONO16, PixelFormat.RGB16):
        return eight_bits(pixels, 16 if exposure is None else exposure.bits)
    return np.asarray(pixels, dtype=np.uint8)


def grey_of(image: CameraImage) -> Image:
    """A camera's image in grey values of 8 bit, shape (height, width)."""
    return eight_bit_grey(image.pixels, image.pixel_format, image.exposure)
