"""Calls and replies of the controller's service: values to bytes and back, without I/O.

The bytes are made and read by the binary protocol of the ``thrift`` package on transports in
memory. Units are the controller's own: metres, radians, seconds; percent where a call says so.
"""

import struct
from collections.abc import Callable
from typing import Any

from thrift.protocol.TBinaryProtocol import TBinaryProtocol
from thrift.Thrift import TApplicationException, TException, TMessageType, TType
from thrift.transport.TTransport import TMemoryBuffer

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun_rpc.codec.framing import MAX_MESSAGE_BYTES
from drivers.robot.siasun_rpc.codec.messages import (
    SEQUENCE_NUMBER,
    Argument,
    MethodUnknown,
    Request,
    Value,
)
from drivers.robot.siasun_rpc.codec.signatures import NO_TRIGGER, SIGNATURES, TRIGGER_FIELDS

_WIRE_TYPES = {
    "b": TType.BOOL, "y": TType.BYTE, "h": TType.I16, "i": TType.I32, "d": TType.DOUBLE,
    "s": TType.STRING, "D": TType.LIST, "B": TType.LIST, "S": TType.LIST, "O": TType.STRUCT,
}  # fmt: skip
_ELEMENTS = {"D": TType.DOUBLE, "B": TType.BYTE, "S": TType.STRING}


def request(method: str, *arguments: Argument) -> Request:
    """Pack a call. Structures of triggers are filled in; all other arguments must be given."""
    signature = SIGNATURES[method]
    transport = TMemoryBuffer()
    protocol = TBinaryProtocol(transport, strictRead=True, strictWrite=True)
    protocol.writeMessageBegin(method, TMessageType.CALL, SEQUENCE_NUMBER)
    given = iter(arguments)
    for number, letter in enumerate(signature.arguments, start=1):
        protocol.writeFieldBegin("", _WIRE_TYPES[letter], number)
        if letter == NO_TRIGGER:
            _write_no_trigger(protocol)
        else:
            _write(protocol, letter, next(given))
    protocol.writeFieldStop()
    if next(given, None) is not None:
        raise TypeError(f"too many arguments for {method}")
    return Request(method, bytes(transport.getvalue()))


def reply(method: str, message: bytes) -> Value:
    """The result of a call; raises ``MethodUnknown`` or ``ProtocolViolation``."""
    transport = TMemoryBuffer(message)
    protocol = TBinaryProtocol(
        transport,
        strictRead=True,
        string_length_limit=MAX_MESSAGE_BYTES,
        container_length_limit=MAX_MESSAGE_BYTES,
    )
    try:
        value = _read_reply(protocol, method)
    except (TException, EOFError, ValueError, struct.error) as error:
        raise ProtocolViolation(f"reply to {method}: {error}") from error
    if transport.read(1):
        raise ProtocolViolation(f"reply to {method} is followed by other bytes")
    return value


def _read_reply(protocol: Any, method: str) -> Value:
    name, kind, number = protocol.readMessageBegin()
    if name != method or number != SEQUENCE_NUMBER:
        raise ProtocolViolation(f"reply to {name!r} number {number} where {method} was asked")
    if kind == TMessageType.EXCEPTION:
        failure = TApplicationException()
        failure.read(protocol)
        if failure.type == TApplicationException.UNKNOWN_METHOD:
            raise MethodUnknown(f"this controller does not know {method}")
        raise ProtocolViolation(f"{method} ended with an exception of the service: {failure}")
    if kind != TMessageType.REPLY:
        raise ProtocolViolation(f"message of kind {kind} where a reply to {method} was expected")
    letter = SIGNATURES[method].result
    value: Value = None
    found = letter == "v"
    while True:
        _, wire_type, field = protocol.readFieldBegin()
        if wire_type == TType.STOP:
            break
        if field == 0 and letter != "v" and wire_type == _WIRE_TYPES[letter]:
            value, found = _read(protocol, letter), True
        else:
            protocol.skip(wire_type)
    if not found:
        raise ProtocolViolation(f"reply to {method} without a result")
    return value


def _write(protocol: Any, letter: str, value: Argument) -> None:
    match letter:
        case "b":
            protocol.writeBool(value)
        case "h":
            protocol.writeI16(value)
        case "i":
            protocol.writeI32(value)
        case "y":
            protocol.writeByte(value)
        case "d":
            protocol.writeDouble(value)
        case "s":
            protocol.writeString(value)
        case "D":
            assert isinstance(value, list)
            protocol.writeListBegin(TType.DOUBLE, len(value))
            for element in value:
                protocol.writeDouble(element)


def _write_no_trigger(protocol: Any) -> None:
    for number, (letter, value) in enumerate(TRIGGER_FIELDS, start=1):
        protocol.writeFieldBegin("", _WIRE_TYPES[letter], number)
        _write(protocol, letter, value)
    protocol.writeFieldStop()


def _read(protocol: Any, letter: str) -> Value:
    one: dict[str, Callable[[], Any]] = {
        "b": protocol.readBool, "h": protocol.readI16, "i": protocol.readI32,
        "s": protocol.readString, "D": protocol.readDouble, "B": protocol.readByte,
        "S": protocol.readString,
    }  # fmt: skip
    if letter not in _ELEMENTS:
        return one[letter]()  # type: ignore[no-any-return]
    element, count = protocol.readListBegin()
    if element != _ELEMENTS[letter] and count:
        raise ProtocolViolation(f"list of type {element} where {_ELEMENTS[letter]} was expected")
    return [one[letter]() for _ in range(count)]
