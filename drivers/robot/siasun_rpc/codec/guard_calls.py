"""The few calls of the guard, packed and read without the library and without I/O.

The guard's process stays small, and the ``thrift`` package brings an event loop with it. The bytes
are those of docs/protocols/siasun-rpc.md, section 2 (Thrift specification, "Thrift Binary protocol
encoding"); the tests compare them with the library's.
"""

import struct

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun_rpc.codec.messages import (
    SEQUENCE_NUMBER,
    Argument,
    MethodUnknown,
    Request,
    Value,
)
from drivers.robot.siasun_rpc.codec.signatures import SIGNATURES

_CALL, _REPLY, _EXCEPTION = 0x80010001, 0x80010002, 0x80010003
_STOP = 0
_LAYOUTS = {"b": (2, ">?"), "h": (6, ">h"), "i": (8, ">i")}
"""Number of a type in the protocol and its layout, by the letter of ``signatures``."""
_STRING, _LIST, _DOUBLE, _NUMBER = 11, 15, 4, 8
_UNKNOWN_METHOD = 1


def packed(method: str, *arguments: Argument) -> Request:
    """A call with arguments of the letters b, h, i and s; ``TypeError`` for others."""
    letters = SIGNATURES[method].arguments
    if len(letters) != len(arguments):
        raise TypeError(f"{method} takes {len(letters)} arguments")
    data = struct.pack(">I", _CALL) + _text(method) + struct.pack(">i", SEQUENCE_NUMBER)
    for number, (letter, value) in enumerate(zip(letters, arguments, strict=True), start=1):
        if letter == "s" and isinstance(value, str):
            data += struct.pack(">BH", _STRING, number) + _text(value)
        elif letter in _LAYOUTS:
            kind, layout = _LAYOUTS[letter]
            data += struct.pack(">BH", kind, number) + struct.pack(layout, value)
        else:
            raise TypeError(f"the guard packs no {letter} of {method}")
    return Request(method, data + bytes([_STOP]))


def answer(method: str, message: bytes) -> Value:
    """The result of a call, of the letters b, i, D and v; ``MethodUnknown`` or
    ``ProtocolViolation``.

    ``message`` is whole, as ``MessageReader`` hands it out. A reply carries its result and nothing
    else: unlike the library this reads no message with other fields.
    """
    try:
        return _result(method, message)
    except struct.error as error:
        raise ProtocolViolation(f"reply to {method}: {error}") from error


def _result(method: str, message: bytes) -> Value:
    kind, body = _head(method, message)
    if kind == _EXCEPTION:
        raise _refusal(method, body)
    if kind != _REPLY:
        raise ProtocolViolation(f"message of kind {kind & 0xFF} where a reply was expected")
    letter = SIGNATURES[method].result
    if letter == "v":
        value, end = None, 0
    else:
        wire_type, field = struct.unpack_from(">BH", body)
        if field != 0:
            raise ProtocolViolation(f"reply to {method} without a result")
        value, end = _value(method, letter, wire_type, body)
    if body[end:] != bytes([_STOP]):
        raise ProtocolViolation(f"reply to {method} is followed by other bytes")
    return value


def _head(method: str, message: bytes) -> tuple[int, bytes]:
    """Kind of the message, and what follows its number."""
    kind, length = struct.unpack_from(">Ii", message)
    name, rest = message[8 : 8 + max(length, 0)], message[8 + max(length, 0) :]
    (number,) = struct.unpack_from(">i", rest)
    if name != method.encode("ascii") or number != SEQUENCE_NUMBER:
        raise ProtocolViolation(f"reply to {name[:40]!r} number {number} where {method} was asked")
    return kind, rest[4:]


def _value(method: str, letter: str, wire_type: int, body: bytes) -> tuple[Value, int]:
    """The result behind the head of its field, and where it ends."""
    if letter == "D" and wire_type == _LIST:
        element, count = struct.unpack_from(">Bi", body, 3)
        if not 0 <= count <= len(body) or (count and element != _DOUBLE):
            raise ProtocolViolation(f"reply to {method}: list of {count} of type {element}")
        return list(struct.unpack_from(f">{count}d", body, 8)), 8 + 8 * count
    kind, layout = _LAYOUTS.get(letter, (None, ""))
    if wire_type != kind:
        raise ProtocolViolation(f"reply to {method} of type {wire_type}")
    (value,) = struct.unpack_from(layout, body, 3)
    return value, 3 + struct.calcsize(layout)


def _refusal(method: str, body: bytes) -> Exception:
    """An exception of the service: a text (field 1) and a number (field 2), in any order."""
    number, at = 0, 0
    while body[at : at + 1] not in (b"", bytes([_STOP])):
        wire_type, field, value = struct.unpack_from(">BHi", body, at)
        at += 7
        if wire_type == _STRING and value >= 0:
            at += value
        elif wire_type == _NUMBER:
            number = value if field == 2 else number
        else:
            raise ProtocolViolation(f"{method} ended with an exception that cannot be read")
    if number == _UNKNOWN_METHOD:
        return MethodUnknown(f"this controller does not know {method}")
    return ProtocolViolation(f"{method} ended with exception {number} of the service")


def _text(text: str) -> bytes:
    data = text.encode("utf-8")
    return struct.pack(">i", len(data)) + data
