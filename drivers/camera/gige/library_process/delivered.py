"""The image in a buffer of a producer, by what the buffer says of itself (GenTL 1.5, 6.4.4).

Read past harvesters' own view of a buffer: that one unpacks packed formats on the way, keeps the
padding at the end of lines, and takes the image for the first byte of the buffer.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from genicam import gentl
from harvesters.util.pfnc import dict_by_ints
from numpy.typing import NDArray

from drivers.camera.gige.library_process.trouble import GENICAM_ERRORS

T = TypeVar("T")
_IMAGE_PART = int(gentl.PARTDATATYPE_IDS.PART_DATATYPE_2D_IMAGE)
_BIG_ENDIAN = gentl.PIXELENDIANNESS_IDS.PIXELENDIANNESS_BIG
_NS = 1_000_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Delivered:
    """One image; ``data`` lies in the producer's buffer and is good until that is given back."""

    pixel_format: str
    """Name by PFNC, or the number where PFNC does not name it."""
    width: int
    height: int
    data: NDArray[np.uint8]
    """Lines one after the other, without padding; samples of two bytes with the low byte first."""


def delivered(buffer: Any, nodes: Any) -> Delivered | None:
    """The image of a buffer, or None for one without an image.

    ``buffer`` is the module of genicam, ``nodes`` the features of the camera for what the producer
    does not say. Raises ``ValueError`` for a buffer that holds less than its image, or was to hold
    more than it can.
    """
    parts: list[Any] = said(lambda: list(buffer.parts), [])
    image = next((part for part in parts if _is_image(part)), None)
    if parts and image is None:
        return None
    place = _place(buffer) if image is None else _place_of_part(image)
    source = buffer if image is None else image
    number = int(
        _first(
            lambda: source.data_format,
            lambda: buffer.pixel_format,
            lambda: nodes.PixelFormat.get_int_value(),  # noqa: PLW0108 - it may have none
        )
    )
    width = int(_first(lambda: source.width, lambda: nodes.Width.value))
    height = int(_first(lambda: source.height, lambda: nodes.Height.value))
    bits = bits_per_pixel(number)
    data = _written(buffer)[place.offset :]
    lines = _lines(data, (height, width), bits, place.padding)
    if bits == 16 and said(lambda: buffer.pixel_endianness, 0) == _BIG_ENDIAN:
        lines = lines.view(np.uint16).byteswap().view(np.uint8)
    return Delivered(format_name(number) or f"0x{number:08X}", width, height, lines)


def format_name(number: int) -> str:
    """The name of a pixel format by PFNC; empty for a number that it does not have."""
    return str(dict_by_ints.get(number, ""))


def _written(buffer: Any) -> NDArray[np.uint8]:
    """The bytes of a buffer that belong to its last image; a shorter image leaves older ones."""
    if said(lambda: bool(buffer.has_received_larger_payload()), False):  # noqa: FBT003 - unknown
        raise ValueError("more bytes came than the buffer holds")
    data = np.frombuffer(buffer.raw_buffer, dtype=np.uint8)
    written = said(lambda: int(buffer.size_filled), 0)
    return data[:written] if 0 < written < len(data) else data


@dataclass(frozen=True, slots=True)
class _Place:
    """Where an image lies in its buffer, bytes."""

    offset: int
    padding: int
    """Bytes at the end of each line that belong to no pixel."""


def _place(buffer: Any) -> _Place:
    offset = said(lambda: int(buffer.image_offset), 0)
    return _Place(offset, said(lambda: int(buffer.padding_x), 0))


def _place_of_part(part: Any) -> _Place:
    offset = said(lambda: int(part.data_offset), 0)
    return _Place(offset, said(lambda: int(part.x_padding), 0))


def _is_image(part: Any) -> bool:
    return said(lambda: int(part.data_type), -1) == _IMAGE_PART


def time_stamp(buffer: Any, device: Any, nodes: Any) -> tuple[int, int]:
    """What tells one image from another, and the camera's time, ns.

    Both are 0 where nothing is said, the time also where its ticks have no known length.
    """
    ns = said(lambda: int(buffer.timestamp_ns), 0)
    if ns:
        return ns, ns
    ticks = said(lambda: int(buffer.timestamp), 0)
    ticks_per_s = said(lambda: int(device.timestamp_frequency), 0) or said(
        lambda: int(nodes.GevTimestampTickFrequency.value), 0
    )
    return ticks, ticks * _NS // ticks_per_s if ticks_per_s else 0


def bits_per_pixel(number: int) -> int:
    """Bits that a pixel takes, as its number says (PFNC 2.4, 5.1)."""
    return number >> 16 & 0xFF


def said(ask: Callable[[], T], otherwise: T) -> T:
    """What a producer says, or ``otherwise`` where it says by an exception that it does not."""
    try:
        return ask()
    except (*GENICAM_ERRORS, AttributeError):
        return otherwise


def _first(*asks: Callable[[], Any]) -> Any:
    """The first answer; the exception of the last one where nobody answers."""
    for ask in asks[:-1]:
        answer = said(ask, None)
        if answer is not None:
            return answer
    return asks[-1]()


def _lines(
    data: NDArray[np.uint8], shape: tuple[int, int], bits: int, padding: int
) -> NDArray[np.uint8]:
    height, width = shape
    if padding <= 0:
        # Packed lines need not end with a byte, so without padding the image is counted as a whole.
        return _enough(data, -(-width * height * bits // 8))
    line = -(-width * bits // 8)
    return _enough(data, (line + padding) * height).reshape(height, -1)[:, :line].ravel()


def _enough(data: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
    if len(data) < size:
        raise ValueError(f"{len(data)} bytes of buffer, {size} are needed")
    return data[:size]
