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
from dataclasses import dataclass

from cellctl import log
from cellctl.api.modbus.pdu import Responder
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
    idle_s: float = 60.0
    """A PLC writes its heartbeat at least twice a second; one that is silent so long is gone."""
    frame_s: float = 3.0
    """From the first byte of a request to its last, and for an answer to be taken."""


class ModbusServer:
    """Listens and answers; knows connections and frames, and nothing of the cell."""

    def __init__(
        self,
        responder: Responder,
        *,
        allowed_clients: tuple[str, ...] = (),
        limits: ServerLimits | None = None,
    ) -> None:
        """``allowed_clients`` are addresses or networks; empty allows every address."""
        self._responder = responder
        self._allowed = [ipaddress.ip_network(text, strict=False) for text in allowed_clients]
        self._limits = limits or ServerLimits()
        self._server: asyncio.Server | None = None
        self._clients: set[asyncio.Task[None]] = set()
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
        self._clients.add(task)
        try:
            if self._admits(peer):
                _tune(writer)
                _log.info("line connected", peer=str(peer))
                reason = await self._serve(reader, writer, str(peer))
        except TimeoutError:
            reason = "too slow"
        except OSError as error:
            reason = f"connection broke ({error.strerror})"
        except asyncio.CancelledError:
            reason = "server stopped"
        finally:
            self._clients.discard(task)
            self.counters[reason] += 1
            _log.info("line disconnected", peer=str(peer), reason=reason)
            writer.transport.abort()  # answers are out; close() would wait for a dead client

    def _admits(self, peer: _Address) -> bool:
        if len(self._clients) > self._limits.clients:
            return False
        return not self._allowed or any(peer in network for network in self._allowed)

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
            answer = self._responder.answer(pdu, peer)
            self.counters["requests"] += 1
            self.counters["exceptions"] += answer[0] >= 0x80
            writer.write(_HEADER.pack(transaction, 0, len(answer) + 1, unit) + answer)
            async with asyncio.timeout(self._limits.frame_s):
                await writer.drain()
            await asyncio.sleep(0)  # a client that floods must not starve the rest of the loop


def _address(writer: asyncio.StreamWriter) -> _Address:
    """Of the client; one that came in over IPv6 from an IPv4 address is known by the latter."""
    address = ipaddress.ip_address(writer.get_extra_info("peername")[0])
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address


def _tune(writer: asyncio.StreamWriter) -> None:
    writer.transport.set_write_buffer_limits(0)  # drain waits until everything is handed over
    sock = writer.get_extra_info("socket")
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
