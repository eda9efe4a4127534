"""Bytes of the remote interface: golden ones, there and back between driver and fake, and fuzz."""

import contextlib
import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from thrift.Thrift import TType

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun_rpc import protocol
from drivers.robot.siasun_rpc.codec.framing import MAX_MESSAGE_BYTES, MessageReader
from drivers.robot.siasun_rpc.codec.messages import MethodUnknown
from drivers.robot.siasun_rpc.codec.signatures import SIGNATURES, TRIGGER_FIELDS
from fakes.wire.duco.codec import CallError, read_call, write_reply, write_unknown
from tests.wire.siasun_rpc.duco_golden import STATE_REPLY, STOP_CALL, STOP_REPLY_4

I16, I32 = st.integers(-(2**15), 2**15 - 1), st.integers(-(2**31), 2**31 - 1)
FINITE = st.floats(allow_nan=False)
TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
VALUES: dict[str, st.SearchStrategy[Any]] = {
    "b": st.booleans(), "h": I16, "i": I32, "d": FINITE, "s": TEXT,
    "D": st.lists(FINITE, max_size=8), "B": st.lists(st.integers(-128, 127), max_size=8),
    "S": st.lists(TEXT, max_size=5), "v": st.none(),
}  # fmt: skip
RESULTS = {
    "b": (TType.BOOL, 0), "i": (TType.I32, 0), "s": (TType.STRING, 0), "v": (TType.VOID, 0),
    "D": (TType.LIST, TType.DOUBLE), "B": (TType.LIST, TType.BYTE), "S": (TType.LIST, TType.STRING),
}  # fmt: skip


# --- golden


def test_the_driver_writes_the_golden_call() -> None:
    assert protocol.request("stop", True).data == STOP_CALL


def test_the_driver_reads_the_golden_replies() -> None:
    assert protocol.reply("stop", STOP_REPLY_4) == 4
    assert protocol.reply("get_robot_state", STATE_REPLY) == [6, 0, 5, 2]


def test_the_fake_reads_and_writes_the_golden_bytes() -> None:
    assert read_call(STOP_CALL) == ("stop", {1: True}, len(STOP_CALL))
    assert write_reply("stop", TType.I32, 4) == STOP_REPLY_4
    assert write_reply("get_robot_state", TType.LIST, [6, 0, 5, 2], TType.BYTE) == STATE_REPLY


def test_a_heartbeat_without_a_result() -> None:
    assert protocol.reply("rpc_heartbeat", write_reply("rpc_heartbeat", TType.VOID, None)) is None


# --- there and back


@given(st.sampled_from(sorted(SIGNATURES)), st.data())
def test_calls_arrive_at_the_fake(method: str, data: st.DataObject) -> None:
    letters = SIGNATURES[method].arguments
    given_values = [data.draw(VALUES[letter]) for letter in letters if letter != "O"]
    packed = protocol.request(method, *given_values).data
    call = read_call(packed)
    assert call is not None
    name, fields, length = call
    assert (name, length) == (method, len(packed))
    plain = [fields[number] for number, letter in enumerate(letters, 1) if letter != "O"]
    assert plain == given_values
    if "O" in letters:
        trigger = fields[letters.index("O") + 1]
        assert list(trigger.values()) == [value for _, value in TRIGGER_FIELDS]
        assert list(trigger) == list(range(1, 13))


@given(st.sampled_from(sorted(SIGNATURES)), st.data())
def test_replies_arrive_at_the_driver(method: str, data: st.DataObject) -> None:
    letter = SIGNATURES[method].result
    value = data.draw(VALUES[letter])
    message = write_reply(method, RESULTS[letter][0], value, RESULTS[letter][1])
    assert protocol.reply(method, message) == value


@given(st.lists(st.sampled_from([STOP_REPLY_4, STATE_REPLY]), max_size=5), st.data())
def test_messages_are_found_however_they_are_cut(
    messages: list[bytes], data: st.DataObject
) -> None:
    stream, reader, found = b"".join(messages), MessageReader(), []
    while stream:
        size = data.draw(st.integers(1, len(stream)))
        reader.feed(stream[:size])
        stream = stream[size:]
        while (message := reader.next()) is not None:
            found.append(message)
    assert found == messages


# --- what is not allowed


def test_an_unknown_method_is_not_a_damaged_line() -> None:
    with pytest.raises(MethodUnknown, match="get_robot_version"):
        protocol.reply("get_robot_version", write_unknown("get_robot_version"))


@pytest.mark.parametrize(
    "message",
    [
        STOP_REPLY_4 + b"\0",
        STOP_REPLY_4.replace(b"stop", b"stob"),
        STOP_REPLY_4[:12] + b"\0\0\0\1" + STOP_REPLY_4[16:],
        STOP_CALL,
        write_reply("stop", TType.VOID, None),
        write_reply("stop", TType.BOOL, True),
        write_reply("stop", TType.LIST, [4], TType.I32),
    ],
    ids=["tail", "name", "number", "call", "no result", "other type", "list"],
)
def test_other_replies_are_refused(message: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        protocol.reply("stop", message)


@pytest.mark.parametrize(
    "message",
    [
        b"GET / HTTP/1.1\r\n\r\n",
        STOP_REPLY_4[:4] + b"\x7f\xff\xff\xff" + STOP_REPLY_4[8:],
        STOP_REPLY_4[:16] + b"\x0f\0\0" + b"\x03\x7f\xff\xff\xff",
        STOP_REPLY_4[:16] + b"\x0f\0\0" + b"\x03\xff\xff\xff\xff",
        STOP_REPLY_4[:16] + b"\x01\0\0" + b"\0" * 8,
        STOP_REPLY_4[:16] + b"\x0c\0\1" * 9,
        STOP_REPLY_4[:16] + (b"\x0b\0\1" + struct.pack(">i", 8000) + bytes(8000)) * 3,
    ],
    ids=["other protocol", "long name", "long list", "negative", "type", "deep", "long"],
)
def test_what_cannot_be_a_message_is_refused_at_once(message: bytes) -> None:
    reader = MessageReader()
    reader.feed(message)
    with pytest.raises(ProtocolViolation):
        reader.next()


def test_an_endless_message_is_given_up() -> None:
    reader = MessageReader()
    reader.feed(STOP_REPLY_4[:16])
    field = b"\x0b\0\1" + struct.pack(">i", 100) + bytes(100)
    with pytest.raises(ProtocolViolation, match="more than"):  # noqa: PT012 - which piece, is free
        for _ in range(MAX_MESSAGE_BYTES // 100):
            reader.feed(field)
            assert reader.next() is None


# --- fuzz: a value, or ``ProtocolViolation``, and nothing else


@given(st.binary(max_size=200))
def test_any_bytes(data: bytes) -> None:
    reader = MessageReader()
    reader.feed(data)
    with contextlib.suppress(ProtocolViolation):
        reader.next()
    with contextlib.suppress(ProtocolViolation):
        protocol.reply("stop", data)


@given(
    st.sampled_from([STOP_REPLY_4, STATE_REPLY, write_unknown("stop")]),
    st.integers(0, 200),
    st.integers(1, 255),
)
def test_one_changed_byte(message: bytes, at: int, flip: int) -> None:
    at %= len(message)
    damaged = message[:at] + bytes([message[at] ^ flip]) + message[at + 1 :]
    reader = MessageReader()
    reader.feed(damaged)
    with contextlib.suppress(ProtocolViolation):
        whole = reader.next()
        if whole is not None:
            with contextlib.suppress(MethodUnknown):
                protocol.reply("stop", whole)


@given(st.binary(max_size=200))
def test_the_fake_hangs_up_on_any_bytes(data: bytes) -> None:
    with contextlib.suppress(CallError):
        read_call(data)
