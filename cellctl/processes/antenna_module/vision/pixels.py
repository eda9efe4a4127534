"""From an image file to the one plane of grey values that is measured.

A colour camera sees one colour at each pixel. Programs that fill in the other two take them from
neighbours, each colour from other ones, so that an edge in red and one in green are up to half a
pixel apart. Edges are therefore measured in one colour alone: in green, which has twice as many
pixels as the others, and best in the raw mosaic, where every second pixel is a measured green one
and those between are the mean of their four neighbours, which moves no edge. Saturation is used for
the connector's mask of the paper's method and for nothing that is measured to a fraction of a
pixel. Sockets with a coloured insulator may have more contrast in its colour; the channel can be
chosen.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.errors.vision import ImageFileInvalid
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.image_file import read_unchanged

Pixels = Literal["auto", "bayer"]
Channel = Literal["green", "red", "blue"]

_BGR = {"blue": 0, "green": 1, "red": 2}
_ROW_COLUMN = {"red": (0, 0), "blue": (1, 1)}
"""First pixel of a colour in the mosaic RGGB."""
_GREEN_CROSS = np.array([[0, 1, 0], [1, 4, 1], [0, 1, 0]], dtype=np.float32) / 4.0
_BILINEAR = np.array([[1, 2, 1], [2, 4, 2], [1, 2, 1]], dtype=np.float32) / 4.0


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPixels:
    """What is measured, and the colours of the picture when it has any."""

    plane: Image
    """Shape (rows, columns)."""
    colour: NDArray[np.uint8] | None
    """Shape (rows, columns, 3): blue, green, red."""
    warnings: tuple[str, ...] = ()


def read_pixels(path: Path, pixels: Pixels = "auto", channel: Channel = "green") -> MeasuredPixels:
    """Read an 8 bit image, grey, colour or raw mosaic RGGB; raises ``ImageFileInvalid``."""
    image = read_unchanged(path)
    if image.dtype != np.uint8:
        raise ImageFileInvalid(f"{path}: needs 8 bit values, has {image.dtype}")
    try:
        return measured_pixels(np.asarray(image, dtype=np.uint8), pixels, channel)
    except ValueError as error:
        raise ImageFileInvalid(f"{path}: {error}") from error


def measured_pixels(
    image: NDArray[np.uint8], pixels: Pixels = "auto", channel: Channel = "green"
) -> MeasuredPixels:
    """The plane to be measured; raises ``ValueError`` for an image of another form."""
    if image.ndim == 2 and pixels == "bayer":
        return MeasuredPixels(mosaic_plane(image, channel), _colours(image))
    if image.ndim == 2:
        return MeasuredPixels(image, None)
    if image.ndim != 3 or image.shape[2] not in {3, 4}:
        raise ValueError("needs one, three or four channels")
    if pixels == "bayer":
        raise ValueError("a raw mosaic has one channel")
    colour = np.ascontiguousarray(image[:, :, :3])
    if np.array_equal(colour[:, :, 0], colour[:, :, 1]) and np.array_equal(
        colour[:, :, 1], colour[:, :, 2]
    ):
        # Many programs save grey images with three equal channels.
        return MeasuredPixels(np.ascontiguousarray(colour[:, :, 1]), None)
    note = (
        f"measured in {channel} of a colour image: if a program filled in its colours, "
        "edges may be moved; the raw mosaic is better"
    )
    return MeasuredPixels(np.ascontiguousarray(colour[:, :, _BGR[channel]]), colour, (note,))


def mosaic_plane(mosaic: Image, channel: Channel = "green") -> Image:
    """One colour of a raw mosaic RGGB at every pixel, the missing ones from their neighbours."""
    known = np.zeros(mosaic.shape, dtype=np.float32)
    if channel == "green":
        known[0::2, 1::2] = mosaic[0::2, 1::2]
        known[1::2, 0::2] = mosaic[1::2, 0::2]
        kernel = _GREEN_CROSS
    else:
        row, column = _ROW_COLUMN[channel]
        known[row::2, column::2] = mosaic[row::2, column::2]
        kernel = _BILINEAR
    filled = cv2.filter2D(known, -1, kernel, borderType=cv2.BORDER_REFLECT_101)
    return np.asarray(np.rint(filled), dtype=np.uint8)


def _colours(mosaic: Image) -> NDArray[np.uint8]:
    channels: tuple[Channel, ...] = ("blue", "green", "red")
    return np.stack([mosaic_plane(mosaic, channel) for channel in channels], axis=2)
