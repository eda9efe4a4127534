"""Modbus TCP as a device reads it: requests to answers, without I/O.

Written from the MODBUS Application Protocol Specification V1.1b3 and the MODBUS Messaging on TCP/IP
Implementation Guide V1.0b.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

HEADER = struct.Struct(">HHHB")
"""Transaction, protocol (0), length of what follows the length field, unit."""
MAX_LENGTH = 254
"""A PDU of at most 253 bytes, and the unit."""
READ_COILS, READ_INPUTS, READ_REGISTERS, WRITE_COIL, WRITE_COILS = 1, 2, 3, 5, 15
_MAX_BITS, _MAX_REGISTERS, _MAX_WRITTEN = 2000, 125, 1968
"""Most coils or inputs, registers, and written coils of a request (sections 6.1, 6.3, 6.11)."""
_ON, _OFF = 0xFF00, 0x0000


class ExceptionCode(Exception):
    """A request that the device refuses, with the code of its exception response."""

    ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE, DEVICE_FAILURE, BUSY = 1, 2, 3, 4, 6

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


class Image(Protocol):
    """What requests read and write; an address that is not there raises ``ExceptionCode``."""

    def coils(self, start: int, count: int) -> Sequence[bool]:
        """Outputs as they are driven."""
        ...

    def inputs(self, start: int, count: int) -> Sequence[bool]:
        """Inputs as they are now."""
        ...

    def registers(self, start: int, count: int) -> Sequence[int]:
        """Holding registers."""
        ...

    def write_coils(self, start: int, values: Sequence[bool]) -> None:
        """Switch outputs."""
        ...


@dataclass(frozen=True, slots=True)
class Request:
    """One request without its framing."""

    transaction: int
    unit: int
    pdu: bytes


def answer(request: Request, image: Image) -> bytes:
    """The PDU of the answer to a request."""
    function = request.pdu[0]
    try:
        return bytes([function]) + _answered(function, request.pdu[1:], image)
    except ExceptionCode as refusal:
        return bytes([function | 0x80, refusal.code])


def framed(request: Request, pdu: bytes) -> bytes:
    """An answer with the header that belongs to its request."""
    return HEADER.pack(request.transaction, 0, len(pdu) + 1, request.unit) + pdu


def _answered(function: int, data: bytes, image: Image) -> bytes:
    if function in {READ_COILS, READ_INPUTS}:
        start, count = _pair(data)
        _check(1 <= count <= _MAX_BITS)
        read = image.coils if function == READ_COILS else image.inputs
        packed = pack_bits(read(start, count))
        return bytes([len(packed)]) + packed
    if function == READ_REGISTERS:
        start, count = _pair(data)
        _check(1 <= count <= _MAX_REGISTERS)
        values = image.registers(start, count)
        return bytes([2 * count]) + struct.pack(f">{count}H", *values)
    if function == WRITE_COIL:
        address, value = _pair(data)
        _check(value in {_ON, _OFF})
        image.write_coils(address, [value == _ON])
        return data
    if function == WRITE_COILS:
        return _write_coils(data, image)
    raise ExceptionCode(ExceptionCode.ILLEGAL_FUNCTION)


def _write_coils(data: bytes, image: Image) -> bytes:
    _check(len(data) >= 5)
    start, count = _pair(data[:4])
    packed = data[5:]
    _check(1 <= count <= _MAX_WRITTEN and data[4] == len(packed) == (count + 7) // 8)
    image.write_coils(start, [bool(packed[k // 8] >> k % 8 & 1) for k in range(count)])
    return data[:4]


def pack_bits(bits: Sequence[bool]) -> bytes:
    """Eight to a byte, the first one in the lowest bit, filled up with zeros."""
    packed = bytearray((len(bits) + 7) // 8)
    for index, bit in enumerate(bits):
        packed[index // 8] |= int(bit) << index % 8
    return bytes(packed)


def _pair(data: bytes) -> tuple[int, int]:
    _check(len(data) == 4)
    first, second = struct.unpack(">HH", data)
    return first, second


def _check(good: bool) -> None:  # noqa: FBT001  a condition, not an option
    if not good:
        raise ExceptionCode(ExceptionCode.ILLEGAL_VALUE)
