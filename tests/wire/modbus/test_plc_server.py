"""What line PLCs, port scanners and broken clients do to the server."""

import asyncio
import socket
import struct
from collections.abc import AsyncIterator

import pytest

from cellctl.api.modbus.pdu import Responder
from cellctl.api.modbus.register_blocks import RegisterFile
from cellctl.api.modbus.server import ModbusServer, ServerLimits, tune
from cellctl.errors.line import CannotListen
from cellctl.errors.link import PortInUse

READ_TWO = bytes.fromhex("04 0000 0002")


def _ignore(_client: str, _value: int) -> None:
    """A heartbeat that nobody watches."""


def frame(transaction: int, pdu: bytes, *, unit: int = 1, protocol: int = 0) -> bytes:
    return struct.pack(">HHHB", transaction, protocol, len(pdu) + 1, unit) + pdu


class Client:
    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer

    def send(self, data: bytes) -> None:
        self.writer.write(data)

    async def answer(self) -> tuple[int, int, bytes]:
        async with asyncio.timeout(2):
            header = await self.reader.readexactly(7)
            transaction, _, length, unit = struct.unpack(">HHHB", header)
            return transaction, unit, await self.reader.readexactly(length - 1)

    async def closed(self, timeout_s: float = 2.0) -> bool:
        try:
            async with asyncio.timeout(timeout_s):
                return await self.reader.read(1) == b""
        except ConnectionError:
            return True
        except TimeoutError:
            return False


class Rig:
    def __init__(self) -> None:
        self.registers = RegisterFile(on_commit=lambda _client: None, on_heartbeat=_ignore)
        self.registers.publish(tuple(range(100, 225)))
        self.servers: list[ModbusServer] = []
        self.clients: list[Client] = []

    async def server(
        self,
        limits: ServerLimits | None = None,
        allowed: tuple[str, ...] = (),
        line: str = "",
    ) -> ModbusServer:
        responder = Responder(self.registers, ("V", "P", "1"))
        server = ModbusServer(
            responder, allowed_clients=allowed, limits=limits, is_line=line.__eq__
        )
        await server.start("127.0.0.1", 0)
        self.servers.append(server)
        return server

    async def client(self, server: ModbusServer, address: str = "127.0.0.1") -> Client:
        """``address`` is the client's own; every one in 127.0.0.0/8 is this machine."""
        source = (address, 0)
        client = Client(*await asyncio.open_connection("127.0.0.1", server.port, local_addr=source))
        self.clients.append(client)
        return client


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    rig = Rig()
    yield rig
    for client in rig.clients:
        client.writer.transport.abort()
    for server in rig.servers:
        await server.stop()


async def test_pipelined_requests_are_answered_in_order(rig: Rig) -> None:
    client = await rig.client(await rig.server())
    client.send(b"".join(frame(n, READ_TWO) for n in range(200)))
    for n in range(200):
        assert await client.answer() == (n, 1, bytes.fromhex("04 04 0064 0065"))


async def test_a_request_may_arrive_byte_by_byte(rig: Rig) -> None:
    client = await rig.client(await rig.server())
    for byte in frame(9, READ_TWO):
        client.send(bytes([byte]))
        await client.writer.drain()
    assert (await client.answer())[0] == 9


@pytest.mark.parametrize("unit", [0, 1, 17, 247, 255])
async def test_every_unit_id_is_served_and_echoed(rig: Rig, unit: int) -> None:
    client = await rig.client(await rig.server())
    client.send(frame(5, READ_TWO, unit=unit))
    assert (await client.answer())[:2] == (5, unit)


@pytest.mark.parametrize(
    "garbage",
    [
        frame(1, READ_TWO, protocol=1),
        struct.pack(">HHHB", 1, 0, 0, 1),
        struct.pack(">HHHB", 1, 0, 1, 1),
        struct.pack(">HHHB", 1, 0, 255, 1),
        struct.pack(">HHHB", 1, 0, 0xFFFF, 1),
        b"GET / HTTP/1.1\r\nHost: cell\r\n\r\n",
        bytes(range(60)),
    ],
)
async def test_what_is_not_modbus_closes_its_own_connection_only(rig: Rig, garbage: bytes) -> None:
    server = await rig.server()
    bad, good = await rig.client(server), await rig.client(server)
    bad.send(garbage)
    assert await bad.closed()
    good.send(frame(2, READ_TWO))
    assert (await good.answer())[0] == 2
    assert server.counters["not Modbus TCP"] == 1


async def test_good_requests_before_garbage_are_answered(rig: Rig) -> None:
    client = await rig.client(await rig.server())
    client.send(frame(1, READ_TWO) + frame(2, READ_TWO, protocol=7))
    assert (await client.answer())[0] == 1
    assert await client.closed()


async def test_an_exception_answer_keeps_the_connection(rig: Rig) -> None:
    client = await rig.client(await rig.server())
    client.send(frame(1, bytes.fromhex("41")) + frame(2, READ_TWO))
    assert await client.answer() == (1, 1, bytes.fromhex("C1 01"))
    assert (await client.answer())[0] == 2


async def test_a_client_that_stalls_within_a_request_is_dropped(rig: Rig) -> None:
    server = await rig.server(ServerLimits(frame_s=0.1))
    client = await rig.client(server)
    client.send(frame(1, READ_TWO)[:9])
    assert await client.closed()
    assert server.counters["too slow"] == 1


async def test_a_silent_client_is_dropped_and_a_busy_one_is_not(rig: Rig) -> None:
    server = await rig.server(ServerLimits(idle_s=0.3))
    silent, busy = await rig.client(server), await rig.client(server)
    dropped = asyncio.create_task(silent.closed())
    transaction = 0
    while not dropped.done():
        transaction += 1
        busy.send(frame(transaction, READ_TWO))
        assert (await busy.answer())[0] == transaction
        await asyncio.wait([dropped], timeout=0.02)
    assert dropped.result()
    assert server.counters["idle"] == 1


async def test_a_client_that_takes_no_answers_is_dropped(rig: Rig) -> None:
    server = await rig.server(ServerLimits(frame_s=0.2))
    client = await rig.client(server)
    client.writer.transport.pause_reading()  # type: ignore[attr-defined]
    flood = frame(1, bytes.fromhex("04 0000 007D")) * 1000
    dropped = False
    try:
        async with asyncio.timeout(10):
            while not dropped:
                client.send(flood)
                await client.writer.drain()
                dropped = server.counters["too slow"] > 0
    except ConnectionError:
        pass
    other = await rig.client(server)
    other.send(frame(3, READ_TWO))
    assert (await other.answer())[0] == 3
    assert server.counters["too slow"] == 1


async def test_more_clients_than_allowed_are_turned_away(rig: Rig) -> None:
    server = await rig.server(ServerLimits(clients=2))
    first, second = await rig.client(server), await rig.client(server)
    for client in (first, second):
        client.send(frame(1, READ_TWO))
        await client.answer()
    third = await rig.client(server)
    assert await third.closed()
    first.send(frame(2, READ_TWO))
    assert (await first.answer())[0] == 2


async def test_connections_that_have_fallen_silent_make_room(rig: Rig) -> None:
    server = await rig.server(ServerLimits(clients=2, quiet_s=0.0))
    half_open, busy = await rig.client(server), await rig.client(server)
    busy.send(frame(1, READ_TWO))
    await busy.answer()
    plc = await rig.client(server)
    plc.send(frame(7, READ_TWO))
    assert (await plc.answer())[0] == 7
    assert await half_open.closed()
    busy.send(frame(2, READ_TWO))
    assert (await busy.answer())[0] == 2
    assert server.counters["made room"] == 1


async def test_the_line_finds_a_place_among_clients_that_are_all_busy(rig: Rig) -> None:
    server = await rig.server(ServerLimits(clients=2), line="127.0.0.2")
    first, second = await rig.client(server), await rig.client(server)
    for client in (first, second):
        client.send(frame(1, READ_TWO))
        await client.answer()
    plc = await rig.client(server, "127.0.0.2")
    plc.send(frame(7, READ_TWO))
    assert (await plc.answer())[0] == 7
    assert await first.closed()
    second.send(frame(2, READ_TWO))
    assert (await second.answer())[0] == 2


def test_a_peer_without_power_is_found_by_the_kernel() -> None:
    with socket.socket() as connection:
        tune(connection)
        tcp = socket.IPPROTO_TCP
        assert connection.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        idle_s = connection.getsockopt(tcp, socket.TCP_KEEPIDLE)
        probes = connection.getsockopt(tcp, socket.TCP_KEEPCNT)
        found_s = idle_s + probes * connection.getsockopt(tcp, socket.TCP_KEEPINTVL)
        assert found_s <= 15
        assert connection.getsockopt(tcp, socket.TCP_USER_TIMEOUT) <= 15_000


async def test_only_listed_addresses_may_connect(rig: Rig) -> None:
    stranger = await rig.client(await rig.server(allowed=("10.0.0.0/8",)))
    assert await stranger.closed()
    friend = await rig.client(await rig.server(allowed=("10.0.0.0/8", "127.0.0.1")))
    friend.send(frame(1, READ_TWO))
    assert (await friend.answer())[0] == 1


async def test_a_flood_does_not_starve_another_client(rig: Rig) -> None:
    server = await rig.server()
    flooder, line = await rig.client(server), await rig.client(server)
    stop = asyncio.Event()

    async def flood() -> None:
        while not stop.is_set():
            flooder.send(frame(1, READ_TWO) * 500)
            for _ in range(500):
                await flooder.answer()

    flooding = asyncio.create_task(flood())
    for n in range(20):
        line.send(frame(n, READ_TWO))
        assert (await line.answer())[0] == n
    stop.set()
    await flooding


async def test_stopping_drops_clients_and_frees_the_port(rig: Rig) -> None:
    server = await rig.server()
    port = server.port
    client = await rig.client(server)
    client.send(frame(1, READ_TWO))
    await client.answer()
    await server.stop()
    assert await client.closed()
    again = ModbusServer(Responder(rig.registers, ("V", "P", "1")))
    await again.start("127.0.0.1", port)
    await again.stop()


async def test_a_taken_port_and_a_foreign_address_are_clear_faults(rig: Rig) -> None:
    server = await rig.server()
    other = ModbusServer(Responder(rig.registers, ("V", "P", "1")))
    with pytest.raises(PortInUse, match=str(server.port)):
        await other.start("127.0.0.1", server.port)
    with pytest.raises(CannotListen):
        await other.start("192.0.2.1", 0)
