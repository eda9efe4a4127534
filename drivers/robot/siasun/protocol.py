"""SJL/1 records: bytes to values and back, without I/O (docs/protocols/sjl-1.md).

This module is shared by the driver and by the guard's stop channel, so it stays free of arrays.
"""

import re
from collections.abc import Callable, Sequence

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun.records import (
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
)

VERSION = "1"
MAX_RECORD_BYTES = 255
# --- PC to robot


def accept_hello(session: int) -> bytes:
    """OK,HELLO."""
    return _encode("OK", "HELLO", VERSION, str(session))


def refuse_hello(reason: str) -> bytes:
    """NO,HELLO; the PC closes after it."""
    return _encode("NO", "HELLO", reason)


def move_joint(session: int, seq: int, joints_deg: Sequence[float], percent: int) -> bytes:
    """MOVJ."""
    joints = [_fixed(value, 5) for value in joints_deg]
    return _encode("MOVJ", str(session), str(seq), *joints, str(percent))


def move_linear(
    session: int, seq: int, xyzabc: Sequence[float], speed_mm_s: float, acceleration_mm_s2: float
) -> bytes:
    """MOVL."""
    numbers = [_fixed(value, 4) for value in (*xyzabc, speed_mm_s, acceleration_mm_s2)]
    return _encode("MOVL", str(session), str(seq), *numbers)


def step(session: int, seq: int, xyzabc: Sequence[float], speed_mm_s: float) -> bytes:
    """STEP."""
    numbers = [_fixed(value, 4) for value in (*xyzabc, speed_mm_s)]
    return _encode("STEP", str(session), str(seq), *numbers)


def rearm(session: int, seq: int) -> bytes:
    """REARM."""
    return _encode("REARM", str(session), str(seq))


def beat(session: int, count: int) -> bytes:
    """BEAT."""
    return _encode("BEAT", str(session), str(count))


def abort(session: int, abort_id: int) -> bytes:
    """ABORT."""
    return _encode("ABORT", str(session), str(abort_id))


def _encode(*fields: str) -> bytes:
    body = ",".join(fields).encode("ascii")
    return b"%b*%02X\n" % (body, sum(body) & 0xFF)


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


# --- robot to PC


class RecordReader:
    """Splits a byte stream into records.

    ``next`` raises ``ProtocolViolation`` for a bad line and has consumed it then, so the next call
    continues with the line after it. A line that is too long is thrown away up to its LF.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._skipping = False

    def feed(self, data: bytes) -> None:
        """Take bytes as they arrived."""
        self._buffer += data

    def next(self) -> Record | None:
        """The next record, or None when no complete line waits."""
        while (end := self._buffer.find(b"\n")) >= 0:
            line = bytes(self._buffer[:end])
            del self._buffer[: end + 1]
            if self._skipping:
                self._skipping = False
                continue
            if end >= MAX_RECORD_BYTES:
                raise ProtocolViolation(f"record of {end + 1} bytes")
            return decode(line)
        if self._skipping:
            self._buffer.clear()
        elif len(self._buffer) >= MAX_RECORD_BYTES:
            self._buffer.clear()
            self._skipping = True
            raise ProtocolViolation(f"no end of record within {MAX_RECORD_BYTES} bytes")
        return None


def decode(line: bytes) -> Record:
    """One line without its LF; ``ProtocolViolation`` when it is no valid record."""
    body, star, tail = line.removesuffix(b"\r").rpartition(b"*")
    if not star or tail != b"%02X" % (sum(body) & 0xFF):
        raise ProtocolViolation(f"wrong sum: {line[:80]!r}")
    word, *fields = body.decode("ascii", "replace").split(",")
    if word not in _DECODERS:
        raise ProtocolViolation(f"unknown word: {line[:80]!r}")
    try:
        return _DECODERS[word](fields)
    except ValueError as error:
        raise ProtocolViolation(f"{error}: {line[:160]!r}") from None


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
    if fields[1] != VERSION:
        return Hello(version=fields[1])
    _count(fields, 9)
    return Hello(
        version=fields[1],
        channel=fields[2],
        robot=fields[3],
        job_version=fields[4],
        euler=_keyed(fields[5], "EUL"),
        unit=_keyed(fields[6], "UNIT"),
        step_max_mm=float(_match(_LENGTH, _keyed(fields[7], "STEPMAX"))),
        deadman_ms=_integer(_keyed(fields[8], "DEADMAN")),
    )


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


_DECODERS: dict[str, Callable[[list[str]], Record]] = {
    "HELLO": _hello,
    "ACK": _ack,
    "DONE": _done,
    "REJ": _rejected,
    "ABRT": _aborted,
    "DUP": _duplicate,
    "STAT": _status,
    "STOPD": _stop_done,
}
