"""The guard's own reading of the remote interface: golden bytes, the stock library's, and fuzz."""

import contextlib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from thrift.protocol.TBinaryProtocol import TBinaryProtocol
from thrift.Thrift import TApplicationException, TMessageType, TType
from thrift.transport.TTransport import TMemoryBuffer

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun_rpc import protocol
from drivers.robot.siasun_rpc.codec.guard_calls import answer, packed
from drivers.robot.siasun_rpc.codec.messages import MethodUnknown
from fakes.wire.duco.codec import write_reply, write_unknown
from tests.wire.siasun_rpc.duco_golden import STATE_REPLY, STOP_CALL, STOP_REPLY_4

I16, I32 = st.integers(-(2**15), 2**15 - 1), st.integers(-(2**31), 2**31 - 1)
NAME = st.text("abcXYZ019_-", min_size=1, max_size=32)
ARGUMENTS: dict[str, st.SearchStrategy[tuple[Any, ...]]] = {
    "stop": st.tuples(st.booleans()),
    "rpc_heartbeat": st.tuples(I32),
    "robotmoving": st.tuples(),
    "get_tcp_pose_coord": st.tuples(NAME, NAME),
    "read_word_reg": st.tuples(I16),
    "write_word_reg": st.tuples(I16, I32),
}
"""Every call of the guard."""
POSE_REPLY = write_reply("get_tcp_pose_coord", TType.LIST, [0.1, -2.5, 3.0, 0, 0, 0], TType.DOUBLE)
REPLIES: dict[str, st.SearchStrategy[tuple[Any, bytes]]] = {
    "stop": I32.map(lambda value: (value, write_reply("stop", TType.I32, value))),
    "robotmoving": st.booleans().map(
        lambda value: (value, write_reply("robotmoving", TType.BOOL, value))
    ),
    "rpc_heartbeat": st.just((None, write_reply("rpc_heartbeat", TType.VOID, None))),
    "get_tcp_pose_coord": st.lists(st.floats(allow_nan=False), max_size=8).map(
        lambda value: (
            value,
            write_reply("get_tcp_pose_coord", TType.LIST, value, TType.DOUBLE),
        )
    ),
}


def test_the_guard_writes_the_golden_call() -> None:
    assert packed("stop", True).data == STOP_CALL


def test_the_guard_reads_the_golden_reply() -> None:
    assert answer("stop", STOP_REPLY_4) == 4


@given(st.sampled_from(sorted(ARGUMENTS)), st.data())
def test_calls_are_those_of_the_library(method: str, data: st.DataObject) -> None:
    arguments = data.draw(ARGUMENTS[method])
    assert packed(method, *arguments) == protocol.request(method, *arguments)


@given(st.sampled_from(sorted(REPLIES)), st.data())
def test_replies_are_read_as_the_library_reads_them(method: str, data: st.DataObject) -> None:
    value, message = data.draw(REPLIES[method])
    assert answer(method, message) == protocol.reply(method, message) == value


@pytest.mark.parametrize(
    ("method", "arguments"), [("stop", ()), ("movej", (1,) * 5), ("stop", (True, 1))]
)
def test_what_the_guard_does_not_send(method: str, arguments: tuple[Any, ...]) -> None:
    with pytest.raises(TypeError):
        packed(method, *arguments)


def exception(number: int) -> bytes:
    """An exception as the stock library of a server writes it."""
    transport = TMemoryBuffer()
    written = TBinaryProtocol(transport)
    written.writeMessageBegin("stop", TMessageType.EXCEPTION, 0)
    TApplicationException(number, "no").write(written)
    return bytes(transport.getvalue())


def test_an_unknown_method_is_told_from_other_exceptions() -> None:
    for message in (write_unknown("stop"), exception(TApplicationException.UNKNOWN_METHOD)):
        with pytest.raises(MethodUnknown):
            answer("stop", message)
    with pytest.raises(ProtocolViolation, match="exception 6"):
        answer("stop", exception(TApplicationException.INTERNAL_ERROR))


@pytest.mark.parametrize(
    "message",
    [
        b"",
        STOP_REPLY_4[:-1],
        STOP_REPLY_4 + b"\0",
        STOP_REPLY_4.replace(b"stop", b"stob"),
        STOP_REPLY_4[:12] + b"\0\0\0\1" + STOP_REPLY_4[16:],
        STOP_CALL,
        STATE_REPLY,
        write_reply("stop", TType.VOID, None),
        write_reply("stop", TType.BOOL, True),
        write_reply("stop", TType.LIST, [4], TType.I32),
        STOP_REPLY_4[:17] + b"\0\1" + STOP_REPLY_4[19:],
    ],
    ids=[
        "nothing",
        "cut",
        "tail",
        "name",
        "number",
        "call",
        "other",
        "void",
        "type",
        "list",
        "field",
    ],
)
def test_other_replies_are_refused(message: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        answer("stop", message)


@given(st.sampled_from(["stop", "get_tcp_pose_coord", "rpc_heartbeat"]), st.binary(max_size=200))
def test_any_bytes(method: str, data: bytes) -> None:
    with contextlib.suppress(ProtocolViolation, MethodUnknown):
        answer(method, data)


@given(
    st.sampled_from(
        [
            ("stop", STOP_REPLY_4),
            ("stop", write_unknown("stop")),
            ("get_tcp_pose_coord", POSE_REPLY),
        ]
    ),
    st.integers(0, 200),
    st.integers(1, 255),
)
def test_one_changed_byte(reply: tuple[str, bytes], at: int, flip: int) -> None:
    method, message = reply
    at %= len(message)
    damaged = message[:at] + bytes([message[at] ^ flip]) + message[at + 1 :]
    with contextlib.suppress(ProtocolViolation, MethodUnknown):
        answer(method, damaged)
