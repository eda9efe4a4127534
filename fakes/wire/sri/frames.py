"""Binary frames of the SRI interface box, as section 7.3 of its manual lays them out.

AA 55, length (u16 BE, counts everything after itself), package number (u16 BE), data, check.
The check covers the data only: their sum modulo 256, or their CRC-32 (zlib variant, little-endian;
the variant is assumed, and no device has confirmed it).
"""

import struct
import zlib
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

HEADER = b"\xaa\x55"
CHECKS = ("SUM", "CRC32")


def check_bytes(data: bytes, check: str) -> bytes:
    """Trailer of a frame: one byte for ``SUM``, four for ``CRC32``."""
    if check == "CRC32":
        return struct.pack("<I", zlib.crc32(data))
    return bytes([sum(data) & 0xFF])


def build_frame(number: int, data: bytes, check: str = "SUM") -> bytes:
    """One whole frame around its data bytes."""
    trailer = check_bytes(data, check)
    length = 2 + len(data) + len(trailer)
    return HEADER + struct.pack(">HH", length, number & 0xFFFF) + data + trailer


def pack_floats(points: Iterable[Sequence[float] | NDArray[np.float64]]) -> bytes:
    """Units E and M: little-endian float32, all channels of one point, then the next point."""
    return b"".join(struct.pack(f"<{len(point)}f", *point) for point in points)


def pack_counts(points: Iterable[Sequence[float] | NDArray[np.float64]]) -> bytes:
    """Unit C: big-endian uint16, clipped as a converter clips."""
    clipped = ([min(max(round(value), 0), 65535) for value in point] for point in points)
    return b"".join(struct.pack(f">{len(point)}H", *point) for point in clipped)


def frame_length(channels: int, points: int, unit: str, check: str) -> int:
    """Bytes of one frame on the wire."""
    width = 2 if unit == "C" else 4
    return 6 + channels * points * width + (4 if check == "CRC32" else 1)
