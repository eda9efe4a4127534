"""Pixel formats of the GenICam convention (PFNC 2.4) as arrays."""

import re
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.camera import PixelFormat

Pixels = NDArray[np.uint8] | NDArray[np.uint16]
Bytes = NDArray[np.uint8]

# OpenCV names a mosaic by the second pixel of the second row, GenICam by the first of the first.
_DEMOSAIC = {
    "BayerRG": cv2.COLOR_BayerBG2RGB,
    "BayerGR": cv2.COLOR_BayerGB2RGB,
    "BayerGB": cv2.COLOR_BayerGR2RGB,
    "BayerBG": cv2.COLOR_BayerRG2RGB,
}
# Weights of ITU-R BT.601, those of OpenCV's own conversion to grey.
_GREY = np.array([0.299, 0.587, 0.114])
# The whole name: Mono8s has a sign, RGB8_Planar has other places, and both begin like others.
_ONE_SAMPLE = re.compile(
    r"(?P<family>Mono|Bayer(?:RG|GR|GB|BG))"
    r"(?:(?P<bits>8|10|12|14|16)|(?P<of_p>10|12|14)p|(?P<of_packed>10|12)Packed)"
)
_COLOUR = re.compile(r"(RGB|BGR)(a?)(8|10|12|14|16)")
SUPPORTED = (
    "supported are Mono and Bayer of 8, 10, 12, 14 and 16 bit (10p, 12p, 14p, 10Packed and "
    "12Packed too), and RGB, BGR, RGBa and BGRa of 8 to 16 bit, unpacked"
)


@dataclass(frozen=True, slots=True)
class _Layout:
    """What a name says."""

    family: str
    """``Mono``, ``BayerRG`` and so on, ``RGB`` or ``BGR``."""
    bits: int
    """Significant bits of a sample."""
    packing: str = ""
    """``p`` or ``Packed``; empty for samples of whole bytes."""
    channels: int = 1


def _layout(name: str) -> _Layout:
    """Raises ``ValueError`` for a format that is not read here."""
    if found := _ONE_SAMPLE.fullmatch(name):
        packing = "p" if found["of_p"] else "Packed" if found["of_packed"] else ""
        bits = found["bits"] or found["of_p"] or found["of_packed"]
        return _Layout(found["family"], int(bits), packing)
    if found := _COLOUR.fullmatch(name):
        return _Layout(found[1], int(found[3]), channels=4 if found[2] else 3)
    raise ValueError(f"pixel format {name} is not supported; {SUPPORTED}")


def bits_of(name: str) -> int:
    """Significant bits of a sample; raises ``ValueError`` for a format that is not read here."""
    return _layout(name).bits


def decoded(data: Bytes, name: str, width: int, height: int) -> tuple[Pixels, PixelFormat]:
    """An image of ``data`` (bytes as they came) with what its samples are.

    Formats of 10 to 16 bit have their value in the low bits of samples of 16; mosaics become
    colour. Raises ``ValueError`` for a format that is not supported, or for too few bytes.
    """
    layout = _layout(name)
    samples = _samples(data, layout, width * height * layout.channels)
    deep = samples.dtype != np.uint8
    colour = PixelFormat.RGB16 if deep else PixelFormat.RGB8
    if layout.channels > 1:
        channels = samples.reshape(height, width, layout.channels)
        order = slice(None, 3) if layout.family == "RGB" else slice(2, None, -1)
        red_first: Any = np.ascontiguousarray(channels[:, :, order])
        return red_first, colour
    plane = samples.reshape(height, width)
    if layout.family == "Mono":
        return plane, PixelFormat.MONO16 if deep else PixelFormat.MONO8
    mosaic: Any = cv2.cvtColor(plane, _DEMOSAIC[layout.family])
    return mosaic, colour


def grey(pixels: Pixels, pixel_format: PixelFormat, bits: int) -> NDArray[np.uint8]:
    """Reduced to 8 bit grey, shape (height, width)."""
    if pixel_format in (PixelFormat.RGB8, PixelFormat.RGB16):
        pixels = np.asarray(np.rint(pixels @ _GREY), dtype=np.uint16)
    high = pixels if bits == 8 else pixels >> (bits - 8)
    return np.asarray(high, dtype=np.uint8)


def _samples(data: Bytes, layout: _Layout, count: int) -> Pixels:
    if layout.packing == "Packed":
        return _packed_gev(data, count, layout.bits)
    if layout.packing == "p":
        return _packed_lsb(data, count, layout.bits)
    if layout.bits == 8:
        return _whole(data, count)
    return _whole(data, 2 * count).view("<u2")


def _packed_lsb(data: Bytes, count: int, bits: int) -> NDArray[np.uint16]:
    """Samples one after the other, lowest bit first (PFNC "p")."""
    size = -(-count * bits // 8)
    stream = np.unpackbits(_whole(data, size), bitorder="little")[: count * bits]
    weights: NDArray[Any] = 1 << np.arange(bits, dtype=np.uint16)
    return np.asarray(stream.reshape(count, bits) @ weights, dtype=np.uint16)


def _packed_gev(data: Bytes, count: int, bits: int) -> NDArray[np.uint16]:
    """Two samples in three bytes, their low bits in the middle one (GigE Vision "Packed")."""
    low = bits - 8
    mask = (1 << low) - 1
    triples = _whole(data, -(-count // 2) * 3).reshape(-1, 3).astype(np.uint16)
    first = triples[:, 0] << low | triples[:, 1] & mask
    second = triples[:, 2] << low | triples[:, 1] >> 4 & mask
    return np.column_stack([first, second]).ravel()[:count]


def _whole(data: Bytes, size: int) -> Bytes:
    if len(data) < size:
        raise ValueError(f"{len(data)} bytes of image, {size} are needed")
    return data[:size]
