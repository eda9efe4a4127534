"""Finds the end of a message in a stream of bytes, and refuses what cannot be a message.

The service speaks Thrift's strict binary protocol without frames: nothing but its own structure
says how long a message is (Thrift specification, "Thrift Binary protocol encoding"). A library
that reads from a socket waits in the middle of a damaged message for as long as the damage says;
here the length of everything is bounded before a library sees it.
"""

import struct

from cellctl.errors.link import ProtocolViolation

MAX_MESSAGE_BYTES = 16_384
"""The longest reply of a known call has some hundred bytes; lists of errors are longer."""
_MAX_DEPTH = 6
"""Replies that are known have two levels, a structure and a list in it. Without a bound a damaged
one would exhaust the stack of the interpreter."""
_VERSION = 0x8001
_SIZES = {2: 1, 3: 1, 4: 8, 6: 2, 8: 4, 10: 8}
"""Bytes of a value by the number of its type in the protocol: bool, byte, double, i16, i32, i64."""
_STOP, _STRING, _STRUCT, _MAP, _SET, _LIST = 0, 11, 12, 13, 14, 15


class _IncompleteError(Exception):
    """The message goes on beyond what has arrived."""


class MessageReader:
    """Splits a stream of bytes into messages: bytes go in with ``feed``, whole messages come out
    with ``next``."""

    def __init__(self) -> None:
        self._buffer = b""

    def feed(self, data: bytes) -> None:
        """Take what has arrived."""
        self._buffer += data

    def next(self) -> bytes | None:
        """The next whole message, None while there is none; ``ProtocolViolation`` if there cannot
        be one. After that the stream has no meaning any more."""
        if not self._buffer:
            return None
        try:
            end = _Cursor(self._buffer).message()
        except _IncompleteError:
            if len(self._buffer) > MAX_MESSAGE_BYTES:
                raise ProtocolViolation(f"message of more than {MAX_MESSAGE_BYTES} bytes") from None
            return None
        message, self._buffer = self._buffer[:end], self._buffer[end:]
        return message


class _Cursor:
    """Walks over one message. Positions are bytes from its beginning."""

    def __init__(self, buffer: bytes) -> None:
        self._buffer = buffer
        self._at = 0

    def message(self) -> int:
        """End of the message."""
        version, kind = self._unpack(">HxB")
        if version != _VERSION or kind not in {1, 2, 3, 4}:
            raise ProtocolViolation(f"not a message: {self._buffer[:16].hex(' ')}")
        self._string()
        self._skip(4)
        self._struct(0)
        return self._at

    def _struct(self, depth: int) -> None:
        if depth > _MAX_DEPTH:
            raise ProtocolViolation("message with too many levels")
        while (kind := self._unpack(">B")[0]) != _STOP:
            self._skip(2)
            self._value(kind, depth + 1)

    def _value(self, kind: int, depth: int) -> None:
        if kind in _SIZES:
            self._skip(_SIZES[kind])
        elif kind == _STRING:
            self._string()
        elif kind == _STRUCT:
            self._struct(depth)
        elif kind in {_LIST, _SET}:
            element, count = self._unpack(">Bi")
            self._elements((element,), count, depth)
        elif kind == _MAP:
            key, element, count = self._unpack(">BBi")
            self._elements((key, element), count, depth)
        else:
            raise ProtocolViolation(f"unknown type {kind} in a message")

    def _elements(self, kinds: tuple[int, ...], count: int, depth: int) -> None:
        # Every element takes at least one byte, so that a greater count cannot be meant.
        if not 0 <= count <= MAX_MESSAGE_BYTES or depth > _MAX_DEPTH:
            raise ProtocolViolation(f"list of {count} elements, {depth} levels deep")
        for _ in range(count):
            for kind in kinds:
                self._value(kind, depth + 1)

    def _string(self) -> None:
        (length,) = self._unpack(">i")
        if not 0 <= length <= MAX_MESSAGE_BYTES:
            raise ProtocolViolation(f"string of {length} bytes")
        self._skip(length)

    def _unpack(self, layout: str) -> tuple[int, ...]:
        start = self._at
        self._skip(struct.calcsize(layout))
        return struct.unpack_from(layout, self._buffer, start)

    def _skip(self, count: int) -> None:
        self._at += count
        if self._at > len(self._buffer):
            raise _IncompleteError
