"""Channels of a camera: grey, colour, or one colour behind each pixel."""

from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from fakes.render.optics.canvas import Image

Pixels = Literal["grey", "rgb", "bayer"]

_RESPONSES: Final[dict[Pixels, Image]] = {
    "grey": np.array([[0.30, 0.55, 0.15]], dtype=np.float32),
    "rgb": np.eye(3, dtype=np.float32),
    "bayer": np.eye(3, dtype=np.float32),
}


def responses(pixels: Pixels) -> Image:
    """What each channel makes of red, green and blue, shape (channels, 3)."""
    return _RESPONSES[pixels]


def put_together(channels: list[NDArray[np.uint8]], pixels: Pixels) -> NDArray[np.uint8]:
    """The camera's image: (rows, columns), and (rows, columns, 3) for ``rgb``.

    ``bayer`` is RGGB: red at even rows and columns, blue at odd ones, green elsewhere.
    """
    if pixels == "grey":
        return channels[0]
    if pixels == "rgb":
        return np.stack(channels, axis=2)
    red, green, blue = channels
    mosaic = green.copy()
    mosaic[0::2, 0::2] = red[0::2, 0::2]
    mosaic[1::2, 1::2] = blue[1::2, 1::2]
    return mosaic
