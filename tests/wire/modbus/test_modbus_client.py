"""Modbus TCP of the couplers' drivers and of the fake: examples of the specification, and noise."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.errors.link import (
    ConnectTimeout,
    DeviceFault,
    LinkError,
    LinkLost,
    ProtocolViolation,
    ReplyTimeout,
)
from drivers.modbus.client import ModbusClient
from drivers.modbus.settings import CouplerSettings
from fakes.wire.couplers import modbus_pdu
from fakes.wire.couplers.modbus_pdu import ExceptionCode, Request
from tests.rigs.wire.ports import free_ports
from tests.wire.modbus import modbus_golden as golden
from tests.wire.scripted_server import serving


class ExampleImage:
    """The process image of the specification's examples."""

    def __init__(self) -> None:
        self.written: list[tuple[int, list[bool]]] = []

    def coils(self, start: int, count: int) -> Sequence[bool]:
        assert (start, count) == (0x13, 19)
        return golden.COIL_BITS

    def inputs(self, start: int, count: int) -> Sequence[bool]:
        assert (start, count) == (0xC4, 22)
        return golden.INPUT_BITS

    def registers(self, start: int, count: int) -> Sequence[int]:
        assert (start, count) == (0x6B, 3)
        return golden.REGISTER_VALUES

    def write_coils(self, start: int, values: Sequence[bool]) -> None:
        if start >= 0x4000:
            raise ExceptionCode(ExceptionCode.ILLEGAL_ADDRESS)
        self.written.append((start, list(values)))


@pytest.mark.parametrize(("asked", "answered"), golden.EXCHANGES)
def test_golden_frames_at_the_fake(asked: bytes, answered: bytes) -> None:
    image = ExampleImage()
    request = Request(0x15, 1, asked[7:])
    assert modbus_pdu.framed(request, modbus_pdu.answer(request, image)) == answered
    if asked == golden.WRITE_COIL[0]:
        assert image.written == [(0xAC, [True])]
    if asked == golden.WRITE_COILS[0]:
        bits = [True, False, True, True, False, False, True, True, True, False]
        assert image.written == [(0x13, bits)]


@given(st.binary(min_size=1, max_size=40))
def test_noise_at_the_fake_is_an_exception_or_an_answer(pdu: bytes) -> None:
    class Zeros:
        def coils(self, start: int, count: int) -> Sequence[bool]:
            return [False] * count

        inputs = coils

        def registers(self, start: int, count: int) -> Sequence[int]:
            return [0] * count

        def write_coils(self, start: int, values: Sequence[bool]) -> None:
            return

    answered = modbus_pdu.answer(Request(1, 1, pdu), Zeros())
    assert answered[0] & 0x7F == pdu[0] & 0x7F


def settings(port: int) -> CouplerSettings:
    return CouplerSettings(host="127.0.0.1", port=port, reply_timeout_s=0.3, connect_timeout_s=1.0)


async def read_request(reader: asyncio.StreamReader) -> bytes:
    header = await reader.readexactly(6)
    return header + await reader.readexactly(header[5])


def renumbered(frame: bytes, request: bytes) -> bytes:
    """An example with the transaction number of a request."""
    return request[:2] + frame[2:]


Call = Callable[[ModbusClient], Awaitable[object]]


@pytest.mark.parametrize(
    ("exchange", "call", "value"),
    [
        (golden.COILS, lambda c: c.read_outputs(0x13, 19), golden.COIL_BITS),
        (golden.INPUTS, lambda c: c.read_inputs(0xC4, 22), golden.INPUT_BITS),
        (golden.WRITE_COIL, lambda c: c.write_output(0xAC, value=True), None),
    ],
)
async def test_golden_frames_at_the_driver(
    exchange: tuple[bytes, bytes], call: Call, value: object
) -> None:
    asked: list[bytes] = []

    def script(request: bytes) -> bytes:
        asked.append(request)
        return renumbered(exchange[1], request)

    async with serving(read_request, script) as port:
        client = ModbusClient("io", settings(port))
        await client.open()
        assert await call(client) == value
        client.close()
    assert asked == [renumbered(exchange[0], asked[0])]


async def test_one_register() -> None:
    async with serving(read_request, lambda r: r[:4] + bytes.fromhex("0005010302022b")) as port:
        client = ModbusClient("io", settings(port))
        await client.open()
        assert await client.read_register(0x1120) == 0x022B
        client.close()


async def test_a_refusal_leaves_the_connection() -> None:
    async with serving(read_request, lambda r: renumbered(golden.REFUSAL[1], r)) as port:
        client = ModbusClient("io", settings(port))
        await client.open()
        with pytest.raises(DeviceFault, match="no such address"):
            await client.write_output(0x4000, value=True)
        assert client.connected
        client.close()


WRONG_ANSWERS = {
    "another transaction": lambda r: bytes([r[0], r[1] ^ 1]) + r[2:],
    "another unit": lambda r: r[:6] + bytes([r[6] + 1]) + r[7:],
    "another function": lambda r: r[:4] + bytes.fromhex("000401010101"),
    "another address": lambda r: r[:9] + bytes([r[9] ^ 1]) + r[10:],
    "another value": lambda r: r[:10] + b"\0\0",
    "too short": lambda r: r[:5] + bytes([4]) + r[6:10],
}


@pytest.mark.parametrize("answer", WRONG_ANSWERS.values(), ids=WRONG_ANSWERS)
async def test_answers_that_do_not_fit_end_the_connection(
    answer: Callable[[bytes], bytes],
) -> None:
    async with serving(read_request, answer) as port:
        client = ModbusClient("io", settings(port))
        await client.open()
        # Which fault it is depends on whether pymodbus passes the answer on, waits for the rest of
        # it, or drops the connection because it cannot decode it.
        with pytest.raises((ProtocolViolation, ReplyTimeout, LinkLost)):
            await client.write_output(0x00AC, value=True)
        assert not client.connected
        with pytest.raises(LinkLost):
            await client.write_output(0x00AC, value=True)
        client.close()


@pytest.mark.parametrize("count", [1, 7, 8, 9])
async def test_bits_that_are_missing_are_a_violation(count: int) -> None:
    async with serving(read_request, lambda r: r[:4] + bytes.fromhex("0005010202ffff")) as port:
        client = ModbusClient("io", settings(port))
        await client.open()
        if count > 8:
            assert await client.read_inputs(0, count) == [True] * count
        else:
            with pytest.raises(ProtocolViolation):
                await client.read_inputs(0, count)
        client.close()


async def test_nobody_listens() -> None:
    with pytest.raises(ConnectTimeout):
        await ModbusClient("io", settings(free_ports(1)[0])).open()


async def test_a_closed_connection_is_seen_at_once() -> None:
    async with serving(read_request, lambda r: None) as port:
        client = ModbusClient("io", settings(port).model_copy(update={"reply_timeout_s": 30.0}))
        await client.open()
        async with asyncio.timeout(2.0):
            with pytest.raises(LinkLost):
                await client.write_output(1, value=True)
        client.close()


@given(noise=st.binary(min_size=1, max_size=60))
def test_noise_is_a_numbered_fault(noise: bytes) -> None:
    async def run() -> None:
        quick = {"reply_timeout_s": 0.02}
        async with serving(read_request, lambda r: r[:2] + noise) as port:
            client = ModbusClient("io", settings(port).model_copy(update=quick))
            await client.open()
            with pytest.raises(LinkError):
                await client.read_inputs(0, 300)
            client.close()

    asyncio.run(run())
