"""Pixel formats of the GenICam convention (PFNC 2.4) as arrays."""

from collections.abc import Callable
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


def bits_of(name: str) -> int:
    """Significant bits of a sample; raises ``ValueError`` for a format that is not read here."""
    digits = "".join(c for c in name.removesuffix("Packed").rstrip("p") if c.isdigit())
    if name in ("RGBa8", "BGRa8"):
        digits = "8"
    if digits not in ("8", "10", "12", "14", "16"):
        raise ValueError(f"pixel format {name} is not supported; {SUPPORTED}")
    return int(digits)


def require_supported(name: str) -> None:
    """Raise ``ValueError`` for a format that is not read here."""
    _family_of(name)
    bits_of(name)


def decoded(data: Bytes, name: str, width: int, height: int) -> tuple[Pixels, PixelFormat]:
    """An image of ``data`` (bytes as they came) with what its samples are.

    Formats of 10 to 16 bit become ``MONO16`` with their value in the low bits; a mosaic becomes
    colour when it has 8 bit. Raises ``ValueError`` for a format that is not supported, or for too
    few bytes.
    """
    return _family_of(name)(data, name, width, height)


def _family_of(name: str) -> Callable[[Bytes, str, int, int], tuple[Pixels, PixelFormat]]:
    family = next((prefix for prefix in _FAMILIES if name.startswith(prefix)), None)
    if family is None:
        raise ValueError(f"pixel format {name} is not supported; {SUPPORTED}")
    return _FAMILIES[family]


def grey(pixels: Pixels, pixel_format: PixelFormat, bits: int) -> NDArray[np.uint8]:
    """Reduced to 8 bit grey, shape (height, width)."""
    if pixel_format is PixelFormat.RGB8:
        return np.asarray(np.rint(pixels @ _GREY), dtype=np.uint8)
    if pixel_format is PixelFormat.MONO16:
        return np.asarray(pixels >> (bits - 8), dtype=np.uint8)
    return np.asarray(pixels, dtype=np.uint8)


def _mono(data: Bytes, name: str, width: int, height: int) -> tuple[Pixels, PixelFormat]:
    pixels = _samples(data, name, width, height)
    return pixels, PixelFormat.MONO8 if pixels.dtype == np.uint8 else PixelFormat.MONO16


def _bayer(data: Bytes, name: str, width: int, height: int) -> tuple[Pixels, PixelFormat]:
    mosaic = _samples(data, name, width, height)
    if mosaic.dtype != np.uint8:
        # Deep mosaics would need a colour format of 16 bit, which no reader of images asks for.
        mosaic = np.asarray(mosaic >> (bits_of(name) - 8), dtype=np.uint8)
    return np.asarray(cv2.cvtColor(mosaic, _DEMOSAIC[name[:7]]), np.uint8), PixelFormat.RGB8


def _colour(data: Bytes, name: str, width: int, height: int) -> tuple[Pixels, PixelFormat]:
    channels = 4 if "a8" in name else 3
    pixels = _whole(data, channels * width * height).reshape(height, width, channels)
    order = slice(None, 3) if name.startswith("RGB") else slice(2, None, -1)
    return np.ascontiguousarray(pixels[:, :, order]), PixelFormat.RGB8


_FAMILIES: dict[str, Callable[[Bytes, str, int, int], tuple[Pixels, PixelFormat]]] = {
    "Mono": _mono,
    **dict.fromkeys(_DEMOSAIC, _bayer),
    "RGB": _colour,
    "BGR": _colour,
}
SUPPORTED = (
    "supported are Mono and Bayer of 8, 10, 12, 14 and 16 bit (10p, 12p, 10Packed and 12Packed "
    "too), RGB8, BGR8, RGBa8 and BGRa8"
)


def _samples(data: Bytes, name: str, width: int, height: int) -> Pixels:
    count = width * height
    bits = bits_of(name)
    if name.endswith("Packed"):
        return _packed_gev(data, count, bits).reshape(height, width)
    if name.endswith("p"):
        return _packed_lsb(data, count, bits).reshape(height, width)
    if bits == 8:
        return _whole(data, count).reshape(height, width)
    return _whole(data, 2 * count).view("<u2").reshape(height, width)


def _packed_lsb(data: Bytes, count: int, bits: int) -> NDArray[np.uint16]:
    """Samples one after the other, lowest bit first (PFNC "p")."""
    size = -(-count * bits // 8)
    stream = np.unpackbits(_whole(data, size), bitorder="little")[: count * bits]
    weights: NDArray[Any] = 1 << np.arange(bits, dtype=np.uint16)
    return np.asarray(stream.reshape(count, bits) @ weights, dtype=np.uint16)


def _packed_gev(data: Bytes, count: int, bits: int) -> NDArray[np.uint16]:
    """Two samples in three bytes, their low bits in the middle one (GigE Vision "Packed")."""
    low = bits - 8
    if low not in (2, 4):
        raise ValueError(f"Packed has 10 or 12 bit, not {bits}; {SUPPORTED}")
    mask = (1 << low) - 1
    triples = _whole(data, -(-count // 2) * 3).reshape(-1, 3).astype(np.uint16)
    first = triples[:, 0] << low | triples[:, 1] & mask
    second = triples[:, 2] << low | triples[:, 1] >> 4 & mask
    return np.column_stack([first, second]).ravel()[:count]


def _whole(data: Bytes, size: int) -> Bytes:
    if len(data) < size:
        raise ValueError(f"{len(data)} bytes of image, {size} are needed")
    return data[:size]
