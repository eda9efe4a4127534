"""Calls in and replies out, with the stock Thrift library and by what the bytes themselves say.

A call is read without a table of its arguments, by the types that stand in it: a driver that sends
a wrong type or a wrong number is seen by the controller's logic and not forgiven here.
"""

from typing import Any

from thrift.protocol.TBinaryProtocol import TBinaryProtocol
from thrift.Thrift import TApplicationException, TException, TMessageType, TType
from thrift.transport.TTransport import TMemoryBuffer

Fields = dict[int, Any]
"""Values of the arguments by their field numbers."""


class CallError(Exception):
    """Bytes that are no call."""


def read_call(data: bytes) -> tuple[str, Fields, int] | None:
    """Name, arguments and length of the first call; None while it is not whole."""
    transport = TMemoryBuffer(data)
    protocol = TBinaryProtocol(transport, strictRead=True)
    try:
        name, kind, _ = protocol.readMessageBegin()
        arguments = _read_struct(protocol)
    except EOFError:
        return None
    except (TException, ValueError) as error:
        raise CallError(str(error)) from error
    if kind != TMessageType.CALL:
        raise CallError(f"message of kind {kind}")
    return name, arguments, transport._buffer.tell()


def write_reply(name: str, kind: int, value: Any, element: int = TType.STOP) -> bytes:
    """Reply with a result of a wire type; ``TType.VOID`` for none, ``element`` for a list."""
    transport = TMemoryBuffer()
    protocol = TBinaryProtocol(transport)
    protocol.writeMessageBegin(name, TMessageType.REPLY, 0)
    if kind != TType.VOID:
        protocol.writeFieldBegin("success", kind, 0)
        if kind == TType.LIST:
            protocol.writeListBegin(element, len(value))
            for one in value:
                _write(protocol, element, one)
        else:
            _write(protocol, kind, value)
    protocol.writeFieldStop()
    return bytes(transport.getvalue())


def write_unknown(name: str) -> bytes:
    """The answer to a method that this version does not have."""
    transport = TMemoryBuffer()
    protocol = TBinaryProtocol(transport)
    protocol.writeMessageBegin(name, TMessageType.EXCEPTION, 0)
    TApplicationException(
        TApplicationException.UNKNOWN_METHOD, f"Invalid method name: '{name}'"
    ).write(protocol)
    return bytes(transport.getvalue())


def _read_struct(protocol: Any) -> Fields:
    fields: Fields = {}
    while True:
        _, kind, number = protocol.readFieldBegin()
        if kind == TType.STOP:
            return fields
        fields[number] = _read(protocol, kind)


def _read(protocol: Any, kind: int) -> Any:
    if kind == TType.STRUCT:
        return _read_struct(protocol)
    if kind == TType.LIST:
        element, count = protocol.readListBegin()
        return [_read(protocol, element) for _ in range(count)]
    readers = {
        TType.BOOL: protocol.readBool, TType.BYTE: protocol.readByte, TType.I16: protocol.readI16,
        TType.I32: protocol.readI32, TType.DOUBLE: protocol.readDouble,
        TType.STRING: protocol.readString,
    }  # fmt: skip
    if kind not in readers:
        raise CallError(f"argument of type {kind}")
    return readers[kind]()


def _write(protocol: Any, kind: int, value: Any) -> None:
    writers = {
        TType.BOOL: protocol.writeBool, TType.BYTE: protocol.writeByte,
        TType.I32: protocol.writeI32, TType.DOUBLE: protocol.writeDouble,
        TType.STRING: protocol.writeString,
    }  # fmt: skip
    writers[kind](value)
