"""Modbus TCP server for one or a few line PLCs; stricter than the usual servers.

Requests of a connection are answered one by one in order, pipelined ones too. A header that is not
Modbus TCP closes the connection. Every unit id is served. Reasons: docs/decisions/0010.
"""

import asyncio
import errno
import ipaddress
import socket
import struct
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from cellctl import log
from cellctl.api.modbus.pdu import Responder
from cellctl.clock import now_s
from cellctl.errors.line import CannotListen
from cellctl.errors.link import PortInUse

_log = log.get(__name__)
_Address = ipaddress.IPv4Address | ipaddress.IPv6Address
_HEADER = struct.Struct(">HHHB")
_LENGTHS = range(2, 255)
"""Unit id and a PDU of 1 to 253 bytes."""
_BUFFER = 1024
"""Bytes read ahead of a client that pipelines; beyond it TCP makes the client wait."""


@dataclass(frozen=True, slots=True)
class ServerLimits:
    """What a connection may cost."""

    clients: int = 8
    """Connections at a time: a PLC has one or two, and an engineer's tools some more."""
    idle_s: float = 60.0
    """A client that is silent for this time is gone: a PLC writes its heartbeat at least twice a
    second."""
    quiet_s: float = 3.0
    """On a full server, a client that has been silent for this time makes room for a new one."""
    frame_s: float = 3.0
    """From the first byte of a request to its last, and for an answer to be taken. Both take
    milliseconds; the rest is for a network that loses packets."""


class ModbusServer:
    """Listens and answers; knows connections and frames, and nothing of the cell."""

    def __init__(
        self,
        responder: Responder,
        *,
        allowed_clients: tuple[str, ...] = (),
        limits: ServerLimits | None = None,
        is_line: Callable[[str], bool] = lambda _address: False,
    ) -> None:
        """``allowed_clients`` are addresses or networks; empty allows every address.

        ``is_line`` tells the address of the line PLC, which finds a place on a full server, too.
        """
        self._responder = responder
        self._allowed = [ipaddress.ip_network(text, strict=False) for text in allowed_clients]
        self._limits = limits or ServerLimits()
        self._server: asyncio.Server | None = None
        self._is_line = is_line
        self._clients: dict[asyncio.Task[None], float] = {}
        """When each connection was last heard of, in the order of connecting."""
        self.counters: Counter[str] = Counter()
        """Connections and why they ended, requests, exceptions answered."""

    async def start(self, host: str, port: int) -> None:
        """Listen; raises ``PortInUse`` or ``CannotListen``."""
        try:
            self._server = await asyncio.start_server(
                self._connected, host, port, limit=_BUFFER, reuse_address=True
            )
        except OSError as error:
            where = f"Modbus TCP on {host}:{port}"
            if error.errno == errno.EADDRINUSE:
                raise PortInUse(where) from error
            raise CannotListen(f"{where}: {error.strerror}") from error

    @property
    def port(self) -> int:
        """The port it listens on, also when 0 was asked for."""
        if self._server is None:
            raise RuntimeError("not started")
        port: int = self._server.sockets[0].getsockname()[1]
        return port

    async def stop(self) -> None:
        """Stop listening and drop all clients. Idempotent."""
        if self._server is not None:
            self._server.close()
            self._server = None
        clients = tuple(self._clients)
        for client in clients:
            client.cancel()
        await asyncio.gather(*clients, return_exceptions=True)

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        peer = _address(writer)
        self.counters["connections"] += 1
        reason = "refused"
        self._clients[task] = now_s()
        try:
            if self._admits(peer) and self._has_room(task, str(peer)):
                writer.transport.set_write_buffer_limits(0)  # drain waits until all is handed over
                tune(writer.get_extra_info("socket"))
                _log.info("line connected", peer=str(peer))
                reason = await self._serve(reader, writer, str(peer))
        except TimeoutError:
            reason = "too slow"
        except OSError as error:
            reason = f"connection broke ({error.strerror})"
        except asyncio.CancelledError as cancelled:
            reason = str(cancelled.args[0]) if cancelled.args else "server stopped"
        finally:
            self._clients.pop(task, None)
            self.counters[reason] += 1
            _log.info("line disconnected", peer=str(peer), reason=reason)
            writer.transport.abort()  # answers are out; close() would wait for a dead client

    def _admits(self, peer: _Address) -> bool:
        return not self._allowed or any(peer in network for network in self._allowed)

    def _has_room(self, task: asyncio.Task[None], peer: str) -> bool:
        """Whether a new connection may stay; on a full server the most silent one makes room.

        A PLC that lost its power leaves connections half open. They must not lock it out when it
        comes back.
        """
        if len(self._clients) <= self._limits.clients:
            return True
        others = {other: heard_s for other, heard_s in self._clients.items() if other is not task}
        silent = min(others, key=others.__getitem__)
        if now_s() - others[silent] < self._limits.quiet_s and not self._is_line(peer):
            return False
        del self._clients[silent]
        silent.cancel("made room")
        return True

    async def _serve(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, peer: str
    ) -> str:
        while True:
            try:
                async with asyncio.timeout(self._limits.idle_s):
                    first = await reader.readexactly(1)
            except asyncio.IncompleteReadError:
                return "closed by client"
            except TimeoutError:
                return "idle"
            try:
                async with asyncio.timeout(self._limits.frame_s):
                    header = first + await reader.readexactly(_HEADER.size - 1)
                    transaction, protocol, length, unit = _HEADER.unpack(header)
                    if protocol != 0 or length not in _LENGTHS:
                        return "not Modbus TCP"
                    pdu = await reader.readexactly(length - 1)
            except asyncio.IncompleteReadError:
                return "closed within a request"
            task = asyncio.current_task()
            if task in self._clients:
                self._clients[task] = now_s()
            answer = self._responder.answer(pdu, peer)
            self.counters["requests"] += 1
            self.counters["exceptions"] += answer[0] >= 0x80
            writer.write(_HEADER.pack(transaction, 0, len(answer) + 1, unit) + answer)
            async with asyncio.timeout(self._limits.frame_s):
                await writer.drain()
            await asyncio.sleep(0)  # a client that floods must not starve the rest of the loop


def _address(writer: asyncio.StreamWriter) -> _Address:
    """Address of the client; one that came in over IPv6 from an IPv4 address is known by the
    latter."""
    address = ipaddress.ip_address(writer.get_extra_info("peername")[0])
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address


def tune(connection: socket.socket) -> None:
    """Answers leave at once, and a peer that is gone without a word is found within 15 s.

    So long takes the first question after 5 s of silence with three more, 3 s apart, and so long
    may an answer stay without its receipt."""
    tcp = socket.IPPROTO_TCP
    connection.setsockopt(tcp, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    connection.setsockopt(tcp, socket.TCP_KEEPIDLE, 5)
    connection.setsockopt(tcp, socket.TCP_KEEPINTVL, 3)
    connection.setsockopt(tcp, socket.TCP_KEEPCNT, 3)
    connection.setsockopt(tcp, socket.TCP_USER_TIMEOUT, 15_000)
