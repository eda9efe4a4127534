"""The fake box over its three transports: TCP, a serial line, CAN on a bus and behind slcan."""

import asyncio
import struct
from collections.abc import AsyncIterator

import can
import pytest
import serial

from fakes.wire.sri.box import SriBox
from fakes.wire.sri.can import CanFrame, CanSession
from fakes.wire.sri.core import SriCore

WRENCH = (10.0, -20.0, -1962.0, 1.5, -2.5, 0.25)


@pytest.fixture
async def box() -> AsyncIterator[SriBox]:
    box = SriBox(lambda time_s: WRENCH)
    yield box
    await box.stop()


async def test_tcp(box: SriBox) -> None:
    port = await box.start_tcp()
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(b"AT+SMPF=500\r\n")
    assert await asyncio.wait_for(reader.readuntil(b"\n"), 2) == b"ACK+SMPF=500$OK\r\n"
    writer.write(b"AT+GSD\r\n")
    stream = await asyncio.wait_for(reader.readexactly(31 * 50), 2)
    assert all(stream[k : k + 4] == b"\xaa\x55\x00\x1b" for k in range(0, len(stream), 31))
    writer.close()
    await writer.wait_closed()


async def test_dropped_clients_may_come_back(box: SriBox) -> None:
    port = await box.start_tcp()
    for _ in range(2):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"AT+SFWV=?\r\n")
        assert (await asyncio.wait_for(reader.readuntil(b"\n"), 2)).startswith(b"ACK+SFWV=")
        box.drop_clients()
        assert await asyncio.wait_for(reader.read(), 2) == b""
        writer.close()
        await writer.wait_closed()


async def test_stop_closes_clients(box: SriBox) -> None:
    port = await box.start_tcp()
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(b"AT+SFWV=?\r\n")
    await asyncio.wait_for(reader.readuntil(b"\n"), 2)
    await box.stop()
    assert await asyncio.wait_for(reader.read(), 2) == b""
    writer.close()
    await writer.wait_closed()


async def test_serial_line(box: SriBox) -> None:
    path = await box.start_serial(115200)

    def talk() -> tuple[bytes, bytes]:
        with serial.Serial(path, 115200, timeout=2) as port:
            port.write(b"AT+SMPF=300\r\n")
            reply = port.readline()
            port.write(b"AT+GSD\r\n")
            return reply, port.read(31 * 20)

    reply, stream = await asyncio.to_thread(talk)
    assert reply == b"ACK+SMPF=300$OK\r\n"
    assert all(stream[k : k + 4] == b"\xaa\x55\x00\x1b" for k in range(0, len(stream), 31))


def triples(bus: can.BusABC, samples: int) -> list[tuple[int, bytes]]:
    """Start the stream, read so many samples, stop."""
    bus.send(can.Message(arbitration_id=0x80, data=[2], is_extended_id=False))
    messages = [bus.recv(2.0) for _ in range(3 * samples)]
    bus.send(can.Message(arbitration_id=0x80, data=[0], is_extended_id=False))
    return [(m.arbitration_id, bytes(m.data)) for m in messages if m is not None]


def check_triples(messages: list[tuple[int, bytes]], samples: int) -> None:
    assert [id_ for id_, _ in messages] == [0x291, 0x292, 0x293] * samples
    first = b"".join(data for _, data in messages[:3])
    assert struct.unpack("<6f", first) == pytest.approx(WRENCH, rel=1e-6)


async def test_slcan(box: SriBox) -> None:
    path = await box.start_slcan()

    def talk() -> list[tuple[int, bytes]]:
        with can.Bus(path, interface="slcan", bitrate=1_000_000, sleep_after_open=0.0) as bus:
            return triples(bus, 10)

    check_triples(await asyncio.to_thread(talk), 10)


async def test_virtual_bus(box: SriBox) -> None:
    with can.Bus("sri", interface="virtual") as near, can.Bus("sri", interface="virtual") as far:
        await box.start_can(far)
        check_triples(await asyncio.to_thread(triples, near, 10), 10)
        await box.stop()


def test_can_single_sample_and_lost_message() -> None:
    core = SriCore(lambda time_s: WRENCH)
    session = CanSession(core)
    session.receive(CanFrame(0x80, b"\x01"), 0.0)
    assert [frame.id for frame in session.emit(0.0)] == [0x291, 0x292, 0x293]
    assert session.due_s is None
    core.faults.inject("skip_every", 2)
    session.receive(CanFrame(0x80, b"\x01"), 0.0)
    assert len(session.emit(0.0)) == 2


@pytest.mark.parametrize(
    "frame", [CanFrame(0x81, b"\x02"), CanFrame(0x80, b"\x02\x00"), CanFrame(0x80, b"\x07")]
)
def test_can_messages_that_are_not_for_the_box(frame: CanFrame) -> None:
    session = CanSession(SriCore(lambda time_s: WRENCH))
    session.receive(frame, 0.0)
    assert session.due_s is None
