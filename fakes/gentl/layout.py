"""8-bit images laid out in the formats of the fake cameras."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.gentl.formats import Format

_COLOURED: Final = 3
"""Dimensions of an image with channels."""


def laid_out(pixels: NDArray[np.uint8], pixel_format: Format) -> NDArray[np.uint8]:
    """An image, (height, width) or with three channels, as a camera of this format delivers it.

    Bytes in one row; no copy of an image that has this format already.

    What is rendered has 8 bits: deeper formats have zeros below them. Width and height are even.
    """
    if pixel_format == "RGB8":
        return _row(_coloured(pixels))
    if pixel_format == "BayerRG8":
        return _row(_mosaic(_coloured(pixels)))
    if pixel_format == "BayerRG12":
        return _deep(_mosaic(_coloured(pixels)))
    grey = pixels if pixels.ndim < _COLOURED else _grey(pixels)
    if pixel_format == "Mono8":
        return _row(grey)
    if pixel_format == "Mono12":
        return _deep(grey)
    pairs = grey.reshape(-1, 2)
    return _row(np.insert(pairs, 1, 0, axis=1))  # low nibbles in the middle


def _deep(values: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return _row((values.astype("<u2") << 4).view(np.uint8))


def _row(values: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(values).reshape(-1)


def _grey(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.asarray(cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY), dtype=np.uint8)


def _coloured(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return pixels if pixels.ndim == _COLOURED else np.repeat(pixels[:, :, None], 3, axis=2)


def _mosaic(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Red at even rows and columns, blue at odd ones, green at the others."""
    mosaic = pixels[:, :, 1].copy()
    mosaic[::2, ::2] = pixels[::2, ::2, 0]
    mosaic[1::2, 1::2] = pixels[1::2, 1::2, 2]
    return mosaic
