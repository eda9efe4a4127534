"""Translates exceptions of the coupler and errors of sockets to numbered faults of the cell."""

from pymodbus.pdu import ExceptionResponse

from cellctl.errors.link import DeviceFault, LinkError, LinkLost, ReplyTimeout

_WORDS = {
    1: "function not supported",
    2: "no such address",
    3: "value not allowed",
    4: "device failure",
    6: "busy",
}
"""Exception codes of the Modbus application protocol, section 7."""


def refused(peer: str, answer: ExceptionResponse) -> LinkError:
    """Fault of an exception response."""
    code = answer.exception_code
    return DeviceFault(f"{peer}: {_WORDS.get(code, 'exception')} (code {code})")


def silent(peer: str, timeout_s: float) -> LinkError:
    """Fault of a request without an answer."""
    return ReplyTimeout(f"{peer}: no reply within {timeout_s:g} s")


def closed(peer: str) -> LinkError:
    """Fault of a connection that ended."""
    return LinkLost(f"{peer}: connection closed")
