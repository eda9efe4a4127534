"""SJL/1 records as the controller's job program writes and reads them (docs/protocols/sjl-1.md)."""

from collections.abc import Iterable, Sequence

import numpy as np

from fakes.world.frames import Array, matrix_to_written

RECORD_MAX = 255
"""Bytes of a record at the most, with the LF (docs/protocols/sjl-1.md, section 2)."""


class RecordError(ValueError):
    """A record that breaks the protocol."""


def encode(fields: Iterable[str]) -> bytes:
    """A record with its sum and LF."""
    body = ",".join(fields).encode("ascii")
    record = body + b"*%02X\n" % (sum(body) % 256)
    if len(record) > RECORD_MAX:
        raise RecordError(f"record of {len(record)} bytes")
    return record


def decode(line: bytes) -> list[str]:
    """Fields of a record without its LF; raises ``RecordError``."""
    line = line.removesuffix(b"\r")
    body, star, digits = line.rpartition(b"*")
    if not star or digits != b"%02X" % (sum(body) % 256):
        raise RecordError(f"wrong sum: {line!r}")
    try:
        return body.decode("ascii").split(",")
    except UnicodeDecodeError as error:
        raise RecordError(f"not ASCII: {line!r}") from error


def fixed(value: float, decimals: int) -> str:
    """Fixed-point number without a negative zero."""
    text = f"{value:.{decimals}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def pose_fields(base_T_flange: Array) -> list[str]:
    """x, y, z, a, b, c with 4 decimals, from a 4x4 matrix."""
    return [fixed(value, 4) for value in matrix_to_written(base_T_flange)]


def joint_fields(joints_rad: Sequence[float]) -> list[str]:
    """j1 to j6 in degrees with 5 decimals."""
    return [fixed(angle, 5) for angle in np.rad2deg(joints_rad)]


def number(text: str) -> float:
    """A fixed-point number; raises ``RecordError`` for exponents, leading plus, nan and inf."""
    digits = text.removeprefix("-").replace(".", "", 1)
    if not (digits.isascii() and digits.isdigit()):
        raise RecordError(f"not a fixed-point number: {text!r}")
    return float(text)


def integer(text: str) -> int:
    """A non-negative integer; raises ``RecordError``."""
    if not (text.isascii() and text.isdigit()):
        raise RecordError(f"not an integer: {text!r}")
    return int(text)
