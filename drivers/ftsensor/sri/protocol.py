"""The box's AT lines and binary frames: bytes to values and back, without I/O.

Both travel on one byte stream, and a reply may stand between two frames. A frame is AA 55, length
(u16 BE), package number (u16 BE), data, check of the data. There is no byte stuffing, so AA 55 and
CR LF occur inside data: only the exact length *and* the check make a frame.
"""

import math
import re
import struct
from dataclasses import dataclass
from typing import Literal, NamedTuple

from drivers.ftsensor.sri import checks

Unit = Literal["E", "C", "M"]
Check = Literal["SUM", "CRC32"]
Crc = Literal["zlib", "mpeg2"]
Six = tuple[float, float, float, float, float, float]

CHANNELS = 6
_HEADER = b"\xaa\x55"
_LONGEST_REPLY = 1024
"""Bytes. The longest known reply, a matrix of 36 numbers, has some 500."""
_REPLY_START = b"ACK+"
_REPLY = re.compile(
    rb"ACK\+(?P<name>[A-Za-z0-9]+)=?(?P<value>[^\r\n$]*)(?P<end>\$OK|[^\r\n]*ERROR[^\r\n]*)\r\n"
)
_MAYBE_REPLY = re.compile(rb"[\x20-\x7e]*\r?")
_GROUP = re.compile(r"\(([^()]*)\)")


@dataclass(frozen=True, slots=True)
class FrameLayout:
    """Which frames to expect; nothing else is accepted."""

    unit: Unit = "E"
    points: int = 1
    check: Check = "SUM"
    crc: Crc = "zlib"

    @property
    def data_bytes(self) -> int:
        """Six channels of each point, two bytes wide as counts, else four."""
        return CHANNELS * self.points * (2 if self.unit == "C" else 4)

    @property
    def total_bytes(self) -> int:
        """Length on the wire."""
        return 6 + self.data_bytes + (4 if self.check == "CRC32" else 1)

    @property
    def point(self) -> struct.Struct:
        """Counts are big-endian, floats little-endian."""
        return struct.Struct(">6H" if self.unit == "C" else "<6f")

    @property
    def checker(self) -> checks.Checker:
        """The function that makes the trailer."""
        if self.check == "SUM":
            return checks.sum_check
        return checks.zlib_check if self.crc == "zlib" else checks.mpeg2_check


class Reply(NamedTuple):
    """``ACK+<name>=<value>$OK``, or one with ERROR in it."""

    name: str
    value: str
    ok: bool


class Frame(NamedTuple):
    """A checked frame."""

    number: int
    points: tuple[tuple[float, ...], ...]
    """Six values each, oldest first, in the unit of the layout."""


def command(name: str, value: str | None = None) -> bytes:
    """``AT+<name>[=<value>]`` with CR LF; ``?`` as value asks."""
    return f"AT+{name}{'' if value is None else f'={value}'}\r\n".encode("ascii")


class StreamDecoder:
    """Splits what arrives into replies and frames, resynchronising byte by byte."""

    def __init__(self, layout: FrameLayout) -> None:
        self.checksum_errors = 0
        self.skipped_bytes = 0
        self._total = layout.total_bytes
        self._data_end = 6 + layout.data_bytes
        self._prefix = _HEADER + (self._total - 4).to_bytes(2)
        self._point = layout.point
        self._check = layout.checker
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[Reply | Frame]:
        """Take bytes, return what became complete, in order."""
        buffer = self._buffer
        if not buffer and len(data) == self._total and data.startswith(self._prefix):
            frame = self._frame(data)  # nearly always the case on a stream that is read at once
            if frame is not None:
                return [frame]
        buffer += data
        found: list[Reply | Frame] = []
        # One pass with an index and one deletion at its end: deleting after every item would move
        # the rest of the buffer each time.
        at, size = 0, len(buffer)
        while at < size:
            item, end = self._item(at, size)
            if item is not None:
                found.append(item)
            elif end == at:
                break
            at = end
        del buffer[:at]
        return found

    def _item(self, at: int, size: int) -> tuple[Reply | Frame | None, int]:
        """The item that begins at a position and its end; the same position to wait for more."""
        buffer = self._buffer
        if buffer.startswith(self._prefix, at):
            end = at + self._total
            if end > size:
                return None, at
            frame = self._frame(bytes(buffer[at:end]))
            if frame is not None:
                return frame, end
            # The header may have been data: the search goes on one byte later, not behind the
            # supposed frame.
            self.checksum_errors += 1
        elif buffer.startswith(_REPLY_START, at):
            match = _REPLY.match(buffer, at)
            if match is not None:
                return _reply(match), match.end()
            if self._may_become_reply(at, size):
                return None, at
        elif self._may_become_start(at, size):
            return None, at
        end = self._next_candidate(at + 1)
        self.skipped_bytes += end - at
        return None, end

    def _frame(self, frame: bytes) -> Frame | None:
        data = frame[6 : self._data_end]
        if frame[self._data_end :] != self._check(data):
            return None
        return Frame(frame[4] << 8 | frame[5], tuple(self._point.iter_unpack(data)))

    def _may_become_reply(self, at: int, size: int) -> bool:
        """A reply is printable up to its CR LF; anything else after ACK+ is data."""
        # Data that look like the beginning of a reply must not hold the stream up for ever.
        if size - at >= _LONGEST_REPLY:
            return False
        match = _MAYBE_REPLY.match(self._buffer, at)
        return match is not None and match.end() == size

    def _may_become_start(self, at: int, size: int) -> bool:
        """True for the first bytes of a frame or reply whose rest has not arrived."""
        if size - at >= len(self._prefix):
            return False
        rest = bytes(self._buffer[at:])
        return self._prefix.startswith(rest) or _REPLY_START.startswith(rest)

    def _next_candidate(self, at: int) -> int:
        """The next position at which a frame or a reply could begin."""
        hits = (self._buffer.find(start, at) for start in (_HEADER[:1], _REPLY_START[:1]))
        return min((hit for hit in hits if hit >= 0), default=len(self._buffer))


def _reply(match: re.Match[bytes]) -> Reply:
    # How the box words an error is not documented; anything but the one known good end is none.
    ok = match["end"] == b"$OK"
    return Reply(match["name"].decode(), match["value"].decode("ascii", "replace"), ok)


# --- values of replies


class DataFormat(NamedTuple):
    """The value of SGDM, which the box writes in its own spelling: compare fields, not text."""

    channels: tuple[str, ...]
    unit: str
    points: int
    weights: tuple[float, ...]

    def __str__(self) -> str:
        weights = ",".join(f"{weight:g}" for weight in self.weights)
        return f"({','.join(self.channels)});{self.unit};{self.points};(WMA:{weights})"


def parse_format(text: str) -> DataFormat:
    """The format from the value part of SGDM; ``ValueError`` when it is none."""
    channels, unit, points, weights = text.strip().split(";", 3)
    kind, _, numbers = weights.strip("()").partition(":")
    if kind != "WMA":
        raise ValueError(f"unknown filter in {text!r}")
    # Parsed and compared by its fields, because the box answers in its own spelling: weights as
    # floats, for example.
    names = tuple(name.strip() for name in channels.strip("()").split(","))
    return DataFormat(names, unit, int(points), tuple(float(w) for w in numbers.split(",")))


def parse_six(text: str) -> Six:
    """Six finite numbers from ``v1;…;v6``; ``ValueError`` when they are not."""
    a, b, c, d, e, f = (float(value) for value in text.split(";"))
    # A matrix that holds NaN would be equal to any other within any limit.
    if not all(map(math.isfinite, (a, b, c, d, e, f))):
        raise ValueError(f"{text!r} is not finite")
    return a, b, c, d, e, f


def parse_six_positive(text: str) -> Six:
    """The same of factors that are divided by; ``ValueError`` also for zero and below."""
    values = parse_six(text)
    if min(values) <= 0.0:
        raise ValueError(f"{text!r} is not positive")
    return values


def parse_matrix(text: str) -> tuple[Six, ...]:
    """Six rows of six finite numbers from ``(…);(…);…``; ``ValueError`` when they are not."""
    rows = tuple(parse_six(row.replace(",", ";")) for row in _GROUP.findall(text))
    if len(rows) != CHANNELS:
        raise ValueError(f"{len(rows)} rows in a matrix")
    return rows
