"""SJL/1 records that the robot sends, bytes to values, without I/O (docs/protocols/sjl-1.md)."""

import re
from collections.abc import Callable, Sequence

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun.codec.compact.decoder import END, decode_compact
from drivers.robot.siasun.codec.records import (
    COMPACT_VERSION,
    Aborted,
    Ack,
    Done,
    Duplicate,
    Hello,
    Record,
    Rejected,
    Six,
    Status,
    StopDone,
    StreamFigures,
    StreamOption,
    Tick,
)
from drivers.robot.siasun.protocol import VERSION

MAX_RECORD_BYTES = 255
_COMPACT_HELLO = b"HELLO,SJL,"
_OTHER_FORM = {True: VERSION, False: COMPACT_VERSION}
_HELLO_FIELDS = 9
"""Fields of a hello without its options."""


class RecordReader:
    """Splits a byte stream into records.

    ``next`` raises ``ProtocolViolation`` for a bad line and has consumed it then, so the next call
    continues with the line after it. A line that is too long is thrown away up to its LF. The
    end of the hello that a connection begins with tells the form of all records behind it, so that
    a version that is not known can be told from a robot that says nothing.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._skipping = False
        self._begun = False
        self._compact = False

    def feed(self, data: bytes) -> None:
        """Take bytes as they arrived."""
        self._buffer += data

    def next(self) -> Record | None:
        """The next record, or None when no complete line waits."""
        self._begin()
        while (end := self._buffer.find(END if self._compact else b"\n")) >= 0:
            line = bytes(self._buffer[:end])
            del self._buffer[: end + 1]
            if self._skipping:
                self._skipping = False
                continue
            if end >= MAX_RECORD_BYTES:
                raise ProtocolViolation(f"record of {end + 1} bytes")
            return self._decode(line)
        if self._skipping:
            self._buffer.clear()
        elif len(self._buffer) >= MAX_RECORD_BYTES:
            self._buffer.clear()
            self._skipping = True
            raise ProtocolViolation(f"no end of record within {MAX_RECORD_BYTES} bytes")
        return None

    def _begin(self) -> None:
        """Learn the form from the first end of a record."""
        ends = [place for end in (b"\n", END) if (place := self._buffer.find(end)) >= 0]
        if not self._begun and ends:
            self._begun = True
            first = self._buffer[min(ends)]
            self._compact = first == END[0] and self._buffer.startswith(_COMPACT_HELLO)

    def _decode(self, line: bytes) -> Record:
        if self._compact and not line.startswith(_COMPACT_HELLO):
            return decode_compact(line)
        record = _decode_fields(line) if self._compact else decode(line)
        if isinstance(record, Hello) and record.version == _OTHER_FORM[self._compact]:
            raise ProtocolViolation(f"hello of SJL/{record.version} in another form: {line!r}")
        return record


def decode(line: bytes) -> Record:
    """One line without its LF; ``ProtocolViolation`` when it is no valid record."""
    body, star, tail = line.removesuffix(b"\r").rpartition(b"*")
    # The sum before the fields: a digit that changes on the way still parses (docs/decisions/0002).
    if not star or tail != b"%02X" % (sum(body) & 0xFF):
        raise ProtocolViolation(f"wrong sum: {line[:80]!r}")
    return _decode_fields(body)


def _decode_fields(body: bytes) -> Record:
    word, *fields = body.decode("ascii", "replace").split(",")
    if word not in _DECODERS:
        raise ProtocolViolation(f"unknown word: {body[:80]!r}")
    try:
        return _DECODERS[word](fields)
    except ValueError as error:
        raise ProtocolViolation(f"{error}: {body[:160]!r}") from None


_LENGTH = re.compile(r"-?\d{1,6}\.\d{4}", re.ASCII)
_JOINT = re.compile(r"-?\d{1,3}\.\d{5}", re.ASCII)
_INTEGER = re.compile(r"\d{1,10}", re.ASCII)
_REASON = re.compile(r"[A-Z]{1,16}", re.ASCII)


def _match(pattern: re.Pattern[str], text: str) -> str:
    if pattern.fullmatch(text) is None:
        raise ValueError(f"bad field {text!r}")
    return text


def _count(fields: list[str], expected: int) -> None:
    if len(fields) != expected:
        raise ValueError(f"{len(fields)} fields instead of {expected}")


def _integer(text: str) -> int:
    # By a pattern, because Python's own ``int`` also takes spaces, signs and underscores, which no
    # job program of this protocol sends.
    return int(_match(_INTEGER, text))


def _flag(text: str) -> bool:
    if text not in ("0", "1"):
        raise ValueError(f"bad flag {text!r}")
    return text == "1"


def _six(fields: Sequence[str], pattern: re.Pattern[str]) -> Six:
    x, y, z, a, b, c = (float(_match(pattern, text)) for text in fields)
    return x, y, z, a, b, c


def _keyed(text: str, key: str) -> str:
    name, _, value = text.partition("=")
    if name != key:
        raise ValueError(f"expected {key}=, got {text!r}")
    return value


def _hello(fields: list[str]) -> Hello:
    if len(fields) < 2 or fields[0] != "SJL":
        raise ValueError("not a hello of SJL")
    # Nothing behind the version is read: another version may order its fields in another way, and
    # the handshake refuses it anyway.
    if fields[1] not in (VERSION, COMPACT_VERSION):
        return Hello(version=fields[1])
    _count(fields[:_HELLO_FIELDS], _HELLO_FIELDS)
    return Hello(
        version=fields[1],
        acceleration_max_mm_s2=_acceleration(fields),
        channel=fields[2],
        robot=fields[3],
        job_version=fields[4],
        euler=_keyed(fields[5], "EUL"),
        unit=_keyed(fields[6], "UNIT"),
        step_max_mm=float(_match(_LENGTH, _keyed(fields[7], "STEPMAX"))),
        deadman_ms=_integer(_keyed(fields[8], "DEADMAN")),
        stream=_stream_option(fields[_HELLO_FIELDS:]),
    )


def _acceleration(fields: list[str]) -> float:
    """What 100 percent mean: needed where a job program takes percents, and not sent elsewhere."""
    if fields[1] == VERSION:
        return 0.0
    _count(fields[_HELLO_FIELDS:], 1)
    acceleration = float(_match(_LENGTH, _keyed(fields[_HELLO_FIELDS], "ACC")))
    if acceleration <= 0.0:
        raise ValueError("a hello without an acceleration")
    return acceleration


def _stream_option(options: list[str]) -> StreamOption | None:
    """What ``STREAM=…`` among the options offers. Options that are not known here are passed over,
    so that a newer job program can still do everything else."""
    offers = [text.removeprefix("STREAM=") for text in options if text.startswith("STREAM=")]
    if not offers:
        return None
    _count(offers, 1)
    period_ms, *lengths, loss_ms = fields = offers[0].split("/")
    _count(fields, 6)
    step_mm, step_deg, travel_mm, travel_deg = (float(_match(_LENGTH, text)) for text in lengths)
    figures = StreamFigures(step_mm, step_deg, travel_mm, travel_deg, _integer(loss_ms))
    if not _integer(period_ms):
        raise ValueError("a stream without a period")
    return StreamOption(_integer(period_ms), figures)


def _ack(fields: list[str]) -> Ack:
    _count(fields, 1)
    return Ack(_integer(fields[0]))


def _done(fields: list[str]) -> Done:
    _count(fields, 7)
    return Done(_integer(fields[0]), _six(fields[1:], _LENGTH))


def _rejected(fields: list[str]) -> Rejected:
    _count(fields, 2)
    return Rejected(_integer(fields[0]), _match(_REASON, fields[1]))


def _aborted(fields: list[str]) -> Aborted:
    _count(fields, 8)
    reason = _match(_REASON, fields[1])
    return Aborted(_integer(fields[0]), reason, _six(fields[2:], _LENGTH))


def _duplicate(fields: list[str]) -> Duplicate:
    _count(fields, 1)
    return Duplicate(_integer(fields[0]))


def _status(fields: list[str]) -> Status:
    _count(fields, 21)
    if fields[2] not in ("MAN", "AUT", "REM"):
        raise ValueError(f"bad mode {fields[2]!r}")
    return Status(
        count=_integer(fields[0]),
        robot_ms=_integer(fields[1]),
        mode=fields[2],
        emergency_stop=_flag(fields[3]),
        drives_on=_flag(fields[4]),
        moving=_flag(fields[5]),
        latched=_flag(fields[6]),
        error_code=_integer(fields[7]),
        override_percent=_integer(fields[8]),
        flange_xyzabc=_six(fields[9:15], _LENGTH),
        joints_deg=_six(fields[15:], _JOINT),
    )


def _stop_done(fields: list[str]) -> StopDone:
    _count(fields, 7)
    return StopDone(_integer(fields[0]), _six(fields[1:], _LENGTH))


def _tick(fields: list[str]) -> Tick:
    _count(fields, 11)
    number, robot_ms, set_number, late, lost = (_integer(text) for text in fields[:5])
    return Tick(number, robot_ms, set_number, late, lost, _six(fields[5:], _LENGTH))


_DECODERS: dict[str, Callable[[list[str]], Record]] = {
    "HELLO": _hello,
    "ACK": _ack,
    "DONE": _done,
    "REJ": _rejected,
    "ABRT": _aborted,
    "DUP": _duplicate,
    "STAT": _status,
    "STOPD": _stop_done,
    "TICK": _tick,
}
