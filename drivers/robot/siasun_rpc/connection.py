"""One TCP connection to the service: calls out, replies back in the same order."""

import asyncio
import contextlib
import socket
import struct
from collections import deque
from collections.abc import Callable

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, LinkLost, ProtocolViolation, ReplyTimeout
from drivers.robot.siasun_rpc import faults, protocol
from drivers.robot.siasun_rpc.codec.framing import MessageReader
from drivers.robot.siasun_rpc.codec.messages import MethodUnknown, Request, Value

LINGER_S = 0.2
"""Time for what was sent last to leave; it may be a stop."""
_RESET_AT_CLOSE = struct.pack("ii", 1, 0)
"""On, and not for a second: a connection that is closed is reset, and its buffer thrown away."""


class RpcConnection(asyncio.Protocol):
    """A connection that is used for one purpose only, as the vendor asks.

    Calls may be sent before earlier replies have come. A reply that is late, damaged or not asked
    for ends the connection: what follows it would be taken for the answer to something else.
    ``on_lost`` hears of every end but ``close``. With ``dies_with_process`` the far end never gets
    what the network has not taken yet when the connection or the process ends.
    """

    def __init__(
        self,
        label: str,
        on_lost: Callable[[LinkError], None],
        *,
        dies_with_process: bool = False,
    ) -> None:
        self._label = label
        self._on_lost = on_lost
        self._dies_with_process = dies_with_process
        self._reader = MessageReader()
        self._waiting: deque[tuple[str, asyncio.Future[Value]]] = deque()
        self._transport: asyncio.Transport | None = None
        self._news = asyncio.Event()

    def __str__(self) -> str:
        return self._label

    async def open(self, host: str, port: int) -> None:
        """Connect; ``ConnectTimeout`` when nobody is there. The caller limits the time."""
        self._reader = MessageReader()
        try:
            await asyncio.get_running_loop().create_connection(lambda: self, host, port)
        except OSError as error:
            raise faults.cannot_connect(f"{self._label} {host}:{port}", error) from error

    def close(self) -> None:
        """Drop the connection after what was sent has left; whoever waits gets ``LinkLost``."""
        self._end(LinkLost(f"{self._label} was disconnected"))

    def drop(self, fault: LinkError) -> None:
        """End the connection because of a fault."""
        if self._end(fault):
            self._on_lost(fault)

    def send(self, *requests: Request) -> "list[asyncio.Future[Value]]":
        """Send calls in one piece, without waiting; their replies. Without a connection nothing is
        sent and the replies are ``LinkLost``."""
        loop = asyncio.get_running_loop()
        replies: list[asyncio.Future[Value]] = [loop.create_future() for _ in requests]
        if self._transport is None:
            for future in replies:
                _settle(future, LinkLost(f"{self._label} is not connected"))
            return replies
        self._transport.write(b"".join(one.data for one in requests))
        self._waiting.extend(zip((one.method for one in requests), replies, strict=True))
        return replies

    async def exchange(self, *requests: Request, timeout_s: float) -> list[Value]:
        """Send calls and wait for all replies; ``ReplyTimeout`` also ends the connection."""
        try:
            async with asyncio.timeout(timeout_s):
                return await asyncio.gather(*self.send(*requests))
        except TimeoutError:
            names = ", ".join(one.method for one in requests)
            fault = ReplyTimeout(f"{self._label}: no reply to {names} within {timeout_s:g} s")
            self.drop(fault)
            raise fault from None

    def owes(self, methods: frozenset[str]) -> bool:
        """Whether a call of one of these was not answered yet, also one that was given up."""
        return any(method in methods for method, _ in self._waiting)

    async def next_reply(self, timeout_s: float) -> None:
        """Wait for the next reply, or for the end of the connection, but no longer than that."""
        self._news.clear()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                await self._news.wait()

    # -- called by the event loop ---------------------------------------------------------------
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The connection stands."""
        assert isinstance(transport, asyncio.Transport)
        connection: socket.socket = transport.get_extra_info("socket")
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self._dies_with_process:
            # Without it the system would go on sending for a dead process, for minutes.
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET_AT_CLOSE)
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        """Replies, or parts of them."""
        if self._transport is None:
            return
        self._reader.feed(data)
        try:
            while (message := self._reader.next()) is not None:
                self._take(message)
        except ProtocolViolation as fault:
            self.drop(ProtocolViolation(f"{self._label}: {fault.detail}"))

    def connection_lost(self, exc: Exception | None) -> None:
        """The far end has closed, or the network has given up."""
        self.drop(faults.broken(self._label, exc))

    def _take(self, message: bytes) -> None:
        if not self._waiting:
            raise ProtocolViolation("a reply that nobody asked for")
        method, future = self._waiting.popleft()
        self._news.set()
        try:
            value = protocol.reply(method, message)
        except MethodUnknown as unknown:
            # Only that call has failed; the connection is as good as before.
            _settle(future, unknown)
        except ProtocolViolation as fault:
            _settle(future, fault)
            raise
        else:
            if not future.done():
                future.set_result(value)

    def _end(self, fault: LinkError) -> bool:
        """True when there was a connection."""
        transport, self._transport = self._transport, None
        waiting, self._waiting = self._waiting, deque()
        self._news.set()
        for _, future in waiting:
            _settle(future, fault)
        if transport is None:
            return False
        transport.close()
        # A far end that reads nothing would keep it open, with what was not sent, for minutes.
        asyncio.get_running_loop().call_later(LINGER_S, transport.abort)
        return True


def _settle(future: "asyncio.Future[Value]", fault: CellError) -> None:
    if not future.done():
        future.set_exception(fault)
        # A caller that has given up waiting never asks; that is no error of its own.
        future.exception()
