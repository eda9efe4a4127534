"""Modbus requests and answers as bytes, without I/O (Application Protocol V1.1b3).

Function codes 3, 4, 6, 16, 22, 23 and 43/14; all others are answered with exception 01.
"""

import struct
from collections.abc import Callable
from enum import IntEnum

from cellctl.api.modbus.register_blocks import AddressRefused, RegisterFile

READ_HOLDING, READ_INPUT, WRITE_ONE, WRITE_MANY, MASK_WRITE, READ_WRITE, DEVICE_ID = (
    3, 4, 6, 16, 22, 23, 43,
)  # fmt: skip
MAX_READ, MAX_WRITE, MAX_READ_WRITE = 125, 123, 121
"""Registers of one request that are read, written, and written beside a read (sections 6.3, 6.12
and 6.17)."""
_MEI_READ_ID = 0x0E
"""The only MEI type that is served: Read Device Identification (section 6.21)."""
_STREAM_LIMITS = {1: 2, 2: 6, 3: 6}
"""Read-device-id code to its last object: basic, regular, extended (there are none)."""


class Exc(IntEnum):
    """Exception codes in use."""

    ILLEGAL_FUNCTION = 1
    ILLEGAL_ADDRESS = 2
    ILLEGAL_VALUE = 3


class _Malformed(Exception):
    """A field does not fit: exception 03."""


class _Unsupported(Exception):
    """The function is not served: exception 01."""


class Responder:
    """Answers one request after the other from a register file."""

    def __init__(self, registers: RegisterFile, identity: tuple[str, str, str]) -> None:
        """``identity`` is vendor, product and version."""
        self._registers = registers
        self._objects = {number: text.encode("ascii") for number, text in enumerate(identity)}
        self._functions: dict[int, Callable[[bytes, str], bytes]] = {
            READ_HOLDING: lambda body, _client: self._read(body, registers.read_holding),
            READ_INPUT: lambda body, _client: self._read(body, registers.read_input),
            WRITE_ONE: self._write_one,
            WRITE_MANY: self._write_many,
            MASK_WRITE: self._mask_write,
            READ_WRITE: self._read_write,
            DEVICE_ID: lambda body, _client: self._device_id(body),
        }

    def answer(self, pdu: bytes, client: str) -> bytes:
        """The answer to a request of at least one byte; bad requests get their exception.

        ``client`` is the address that the request came from.
        """
        function = pdu[0]
        try:
            return pdu[:1] + self._functions.get(function, _unsupported)(pdu[1:], client)
        except _Unsupported:
            code = Exc.ILLEGAL_FUNCTION
        except AddressRefused:
            code = Exc.ILLEGAL_ADDRESS
        except (_Malformed, struct.error):
            code = Exc.ILLEGAL_VALUE
        return bytes([function | 0x80, code])

    def _read(self, body: bytes, source: Callable[[int, int], tuple[int, ...]]) -> bytes:
        address, count = struct.unpack(">HH", body)
        _check(1 <= count <= MAX_READ)
        return _registers(source(address, count))

    def _write_one(self, body: bytes, client: str) -> bytes:
        address, value = struct.unpack(">HH", body)
        self._registers.write_holding(address, [value], client)
        return body

    def _write_many(self, body: bytes, client: str) -> bytes:
        address, count, size = struct.unpack(">HHB", body[:5])
        _check(1 <= count <= MAX_WRITE and size == 2 * count)
        self._registers.write_holding(address, struct.unpack(f">{count}H", body[5:]), client)
        return body[:4]

    def _mask_write(self, body: bytes, client: str) -> bytes:
        address, and_mask, or_mask = struct.unpack(">HHH", body)
        (present,) = self._registers.read_holding(address, 1)
        value = (present & and_mask) | (or_mask & ~and_mask & 0xFFFF)
        self._registers.write_holding(address, [value], client)
        return body

    def _read_write(self, body: bytes, client: str) -> bytes:
        address, count, to, written, size = struct.unpack(">HHHHB", body[:9])
        _check(1 <= count <= MAX_READ and 1 <= written <= MAX_READ_WRITE and size == 2 * written)
        values = struct.unpack(f">{written}H", body[9:])
        self._registers.read_holding(address, count)  # refuse the read before anything is written
        self._registers.write_holding(to, values, client)
        return _registers(self._registers.read_holding(address, count))

    def _device_id(self, body: bytes) -> bytes:
        if body[:1] != bytes([_MEI_READ_ID]):
            raise _Unsupported
        _, code, first = struct.unpack(">BBB", body)
        _check(1 <= code <= 4)
        if code == 4:
            if first not in self._objects:
                raise AddressRefused
            wanted = [first]
        else:
            # By section 6.21 a stream that asks for an object that is not there begins anew, at the
            # first one; only a single object (code 4) is refused.
            start = first if first in self._objects else 0
            wanted = [n for n in self._objects if start <= n <= _STREAM_LIMITS[code]]
        # Conformity 0x81: basic identification, as a stream and object by object. Nothing follows,
        # because name, product and version always fit into one answer.
        head = struct.pack(">BBBBBB", _MEI_READ_ID, code, 0x81, 0, 0, len(wanted))
        return head + b"".join(
            struct.pack(">BB", n, len(self._objects[n])) + self._objects[n] for n in wanted
        )


def _registers(values: tuple[int, ...]) -> bytes:
    return struct.pack(f">B{len(values)}H", 2 * len(values), *values)


def _unsupported(_body: bytes, _client: str) -> bytes:
    raise _Unsupported


def _check(condition: bool) -> None:  # noqa: FBT001
    if not condition:
        raise _Malformed
