"""Images that come again although a camera has exposed anew: a buffer that nobody has filled."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cellctl.errors.camera import ImageRepeated

Pixels = NDArray[np.uint8] | NDArray[np.uint16]


class RepeatedImages:
    """Compares each exposure of one device with the one before it."""

    def __init__(self, device: str) -> None:
        self._device = device
        self._last: Mapping[str, Pixels] = {}

    def require_new(self, images: Mapping[str, Pixels]) -> None:
        """Raise ``ImageRepeated`` for one that is the last one bit by bit.

        A sensor has noise in each of millions of pixels. An image that is black or glaring all over
        has none, but for a few pixels that are dead or hot: it is left to the checks of its light.
        """
        last, self._last = self._last, images
        for name, image in images.items():
            before = last.get(name)
            if before is None or not np.array_equal(image, before):
                continue
            if np.any((image > image.min()) & (image < image.max())):
                raise ImageRepeated(f"{self._device}: {name}, bit by bit that of the grab before")
