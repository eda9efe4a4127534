"""SJL/2 records that the robot sends (docs/protocols/sjl-2.md): one record to a value, no I/O."""

import re
from collections.abc import Callable, Sequence
from functools import partial

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun.codec.records import (
    Aborted,
    Ack,
    Done,
    Duplicate,
    Record,
    Rejected,
    Six,
    Status,
    StopDone,
)

END = b";"
_NUMBER = re.compile(r"-?\d{1,10}", re.ASCII)
_REASON = re.compile(r"[A-Z]{1,16}", re.ASCII)
_LENGTH, _JOINT = 1e-4, 1e-5
"""Unit of a whole number: mm or degrees of a pose, degrees of a joint."""
_MODES = {0: "MAN", 4: "REM", 8: "AUT"}


def decode_compact(body: bytes) -> Record:
    """One record without its end; ``ProtocolViolation`` when it is no valid one."""
    word, *fields = body.decode("ascii", "replace").split(",")
    if word not in _SHAPES:
        raise ProtocolViolation(f"unknown word: {body[:80]!r}")
    try:
        return _record(word, fields)
    except ValueError as error:
        raise ProtocolViolation(f"{error}: {body[:200]!r}") from None


def _record(word: str, fields: list[str]) -> Record:
    numbers, reason, build = _SHAPES[word]
    if len(fields) != numbers + bool(reason) + 1:
        raise ValueError(f"{len(fields)} fields")
    text = fields.pop(1) if reason else ""
    if reason and _REASON.fullmatch(text) is None:
        raise ValueError(f"bad reason {text!r}")
    *values, total = (_integer(field) for field in fields)
    if sum(values) != total:
        raise ValueError("wrong sum")
    return build(text, values)


def _integer(text: str) -> int:
    if _NUMBER.fullmatch(text) is None:
        raise ValueError(f"bad field {text!r}")
    return int(text)


def _six(values: Sequence[int], unit: float) -> Six:
    x, y, z, a, b, c = (value * unit for value in values)
    return x, y, z, a, b, c


def _status(_: str, values: list[int]) -> Status:
    count, robot_ms, inputs, latched, moving, error_code, override = values[:7]
    # The key cannot stand on two positions: such a byte is wired wrongly, and nothing of it counts.
    if inputs & 12 not in _MODES or not 0 <= inputs < 32:
        raise ValueError(f"bad inputs {inputs}")
    return Status(
        count=count,
        robot_ms=robot_ms,
        mode=_MODES[inputs & 12],
        emergency_stop=bool(inputs & 1),
        drives_on=bool(inputs & 2),
        moving=bool(moving) or bool(inputs & 16),
        latched=bool(latched),
        error_code=error_code,
        override_percent=override,
        flange_xyzabc=_six(values[7:13], _LENGTH),
        joints_deg=_six(values[13:], _JOINT),
    )


def _numbered(build: Callable[[int], Record], _: str, values: list[int]) -> Record:
    return build(values[0])


def _posed(build: Callable[[int, Six], Record], _: str, values: list[int]) -> Record:
    return build(values[0], _six(values[1:], _LENGTH))


_SHAPES: dict[str, tuple[int, bool, Callable[[str, list[int]], Record]]] = {
    "ACK": (1, False, partial(_numbered, Ack)),
    "DUP": (1, False, partial(_numbered, Duplicate)),
    "REJ": (1, True, lambda reason, values: Rejected(values[0], reason)),
    "DONE": (7, False, partial(_posed, Done)),
    "ABRT": (7, True, lambda reason, values: Aborted(values[0], reason, _six(values[1:], _LENGTH))),
    "STOPD": (7, False, partial(_posed, StopDone)),
    "STAT": (19, False, _status),
}
"""How a record is read, by its word: how many numbers it has before the sum, whether a reason
follows the first of them, and what makes a value of them."""
