"""Small pictures in all pixel formats, and a fake camera that sends them."""

import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.camera import PixelFormat
from fakes.wire.cameras.image_server import Picture

WIDTH, HEIGHT = 5, 4
CODES = {PixelFormat.MONO8: 1, PixelFormat.MONO16: 2, PixelFormat.RGB8: 3}
"""Numbers on the wire, from the table of the protocol."""


def pixels(pixel_format: PixelFormat, number: int) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """A picture without symmetry that is another one for each exposure."""
    ramp = np.add.outer(np.arange(HEIGHT) * 16, np.arange(WIDTH)) + number
    if pixel_format is PixelFormat.MONO16:
        return (257 * ramp).astype(np.uint16)
    if pixel_format is PixelFormat.RGB16:
        return np.stack([257 * ramp, 300 * ramp, 400 * ramp], axis=2).astype(np.uint16)
    if pixel_format is PixelFormat.RGB8:
        return np.stack([ramp, ramp + 60, ramp + 120], axis=2).astype(np.uint8)
    return ramp.astype(np.uint8)


class PictureTaker:
    """Takes the pictures of a fake camera, and counts them."""

    def __init__(self, pixel_format: PixelFormat) -> None:
        self.pixel_format = pixel_format
        self.exposures = 0

    async def take(self, faults: frozenset[str]) -> Picture:
        self.exposures += 1
        array = pixels(self.pixel_format, self.exposures)
        payload = array.astype(array.dtype.newbyteorder(">")).tobytes()
        code = CODES[self.pixel_format]
        return Picture(WIDTH, HEIGHT, payload, float(self.exposures), code)
