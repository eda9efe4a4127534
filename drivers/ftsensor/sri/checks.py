"""The two checks of a frame and the two ways to read "CRC32"."""

import zlib
from collections.abc import Callable

Checker = Callable[[bytes], bytes]
"""Data bytes to trailer bytes."""

_POLYNOMIAL = 0x04C11DB7


def sum_check(data: bytes) -> bytes:
    """One byte: the sum of the data modulo 256."""
    return (sum(data) & 0xFF).to_bytes(1)


def zlib_check(data: bytes) -> bytes:
    """CRC-32 as in zlib, little-endian: the variant in the one public driver that checks it."""
    return zlib.crc32(data).to_bytes(4, "little")


def mpeg2_check(data: bytes) -> bytes:
    """CRC-32/MPEG-2, little-endian: what a microcontroller's CRC unit computes."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc = (crc << 8 & 0xFFFFFFFF) ^ _TABLE[crc >> 24 ^ byte]
    return crc.to_bytes(4, "little")


def _entry(value: int) -> int:
    crc = value << 24
    for _ in range(8):
        crc = crc << 1 ^ (_POLYNOMIAL if crc & 0x80000000 else 0)
    return crc & 0xFFFFFFFF


_TABLE = tuple(_entry(value) for value in range(256))
