"""One SJL channel: a listener of this PC, at most one client on it, and that client's session."""

import asyncio
import logging
import random
import socket
from collections.abc import Callable

from cellctl.errors.link import (
    CallerRefused,
    ConnectTimeout,
    LinkError,
    LinkLost,
    ProtocolViolation,
    VersionMismatch,
)
from drivers.robot.siasun import faults
from drivers.robot.siasun.codec.decoder import RecordReader
from drivers.robot.siasun.codec.handshake import HELLO_TIMEOUT_S, SESSIONS, is_robot, refusal
from drivers.robot.siasun.codec.records import Hello, Record
from drivers.robot.siasun.codec.words import Words, words_of

_log = logging.getLogger(__name__)

MOST_STRANGERS = 16
"""Addresses that are remembered: a scan of the network must fill neither memory nor alarms."""


class SjlChannel:
    """A channel that listens until it is closed; the robot may come, go and come back.

    ``on_up`` is called after each accepted hello, ``on_record`` with every record after it,
    ``on_lost`` once at the end of an accepted session, unless ``close`` ended it.
    """

    def __init__(
        self,
        channel: str,
        robot: str,
        *,
        max_deadman_s: float,
        robot_address: str,
        on_up: Callable[[], None],
        on_record: Callable[[Record], None],
        on_lost: Callable[[LinkError], None],
    ) -> None:
        self.hello = Hello("")
        self.session = random.randrange(SESSIONS)
        self._channel = channel
        self._robot = robot
        self._max_deadman_s = max_deadman_s
        self._robot_address = robot_address
        self._strangers: dict[str, CallerRefused | None] = {}
        """Callers that are not the robot, by their address; the fault is None once it was told."""
        self._on_up = on_up
        self._on_record = on_record
        self._on_lost = on_lost
        self._server: asyncio.Server | None = None
        self._client: _Client | None = None
        self._accepted = self._barred = False
        self._changed = asyncio.Event()
        self._refused: LinkError | None = None

    @property
    def connected(self) -> bool:
        """An accepted session stands."""
        return self._accepted

    @property
    def words(self) -> Words:
        """What to say to the job program that has greeted last."""
        return words_of(self.hello)

    def __str__(self) -> str:
        return f"{self._robot} {self._channel}"

    def incidents(self) -> tuple[CallerRefused, ...]:
        """Strangers that have called since the last call, each address once while it listens."""
        new = tuple(one for one in self._strangers.values() if one is not None)
        self._strangers = dict.fromkeys(self._strangers)
        return new

    async def listen(self, host: str, port: int) -> None:
        """Open the port; ``PortInUse`` when it cannot be had."""
        loop = asyncio.get_running_loop()
        self._refused, self._barred = None, False
        self._strangers.clear()
        try:
            self._server = await loop.create_server(lambda: _Client(self), host, port)
        except OSError as error:
            raise faults.cannot_listen(host, port, error) from error

    async def wait_connected(self) -> None:
        """Wait for a session; raises at once when the wrong robot or job program calls, and
        when the channel is closed meanwhile."""
        while not self._accepted:
            if self._server is None:
                raise LinkLost(f"{self} was disconnected")
            if isinstance(self._refused, VersionMismatch):
                raise self._refused
            self._changed.clear()
            await self._changed.wait()

    def timeout(self, timeout_s: float) -> LinkError:
        """What to raise when nobody came in time."""
        if isinstance(self._refused, VersionMismatch):
            return self._refused
        trace = f"; last caller: {self._refused}" if self._refused else ""
        return ConnectTimeout(f"{self} did not connect within {timeout_s:g} s{trace}")

    def send(self, line: bytes) -> None:
        """Hand one record to the socket; ``LinkLost`` when no session stands."""
        if self._client is None or not self._accepted:
            raise LinkLost(f"{self} is not connected")
        self._client.send(line)

    def drop(self, fault: LinkError) -> None:
        """End the session because of a fault; the listener stays."""
        if self._client is not None:
            self._client.abort()
            self._ended(fault)

    def bar(self, fault: LinkError) -> None:
        """End the session because of a fault, and admit nobody before the port is opened anew."""
        self._barred = True
        self.drop(fault)

    async def close(self) -> None:
        """Close client and listener. Idempotent."""
        client, self._client, self._accepted = self._client, None, False
        server, self._server = self._server, None
        if server is not None:
            server.close()
        self._changed.set()
        if client is not None:
            client.abort()
            await client.closed.wait()

    # --- called by the client

    def _admit(self, client: "_Client", caller: str) -> bool:
        if not is_robot(caller, self._robot_address):
            self._refuse(caller)
            return False
        # The first one stays: a second caller could otherwise take a moving robot away from its
        # link.
        if self._client is not None or self._server is None or self._barred:
            _log.warning("%s: second connection refused", self)
            return False
        self._client = client
        return True

    def _refuse(self, caller: str) -> None:
        if caller not in self._strangers and len(self._strangers) < MOST_STRANGERS:
            fault = CallerRefused(f"{self}: {caller} called, the robot is {self._robot_address}")
            self._strangers[caller] = fault
            _log.warning("%s", fault)

    def _record(self, record: Record) -> None:
        if self._accepted:
            if isinstance(record, Hello):
                raise ProtocolViolation(f"{self}: second HELLO in a session")
            self._on_record(record)
        elif isinstance(record, Hello):
            self._greet(record)
        else:
            raise ProtocolViolation(f"{self}: {type(record).__name__} before HELLO")

    def _greet(self, hello: Hello) -> None:
        assert self._client is not None  # a record came from it
        refused = refusal(hello, self._channel, self._robot, self._max_deadman_s)
        if refused is not None:
            word, facts = refused
            self._client.send(words_of(hello).refuse_hello(word))
            self._client.close()
            self._ended(VersionMismatch(f"{self}: {facts}"))
            return
        self.hello = hello
        # A new number for each session, so that a record of the old one that is still under way is
        # told from one of the new.
        self.session = self.session % SESSIONS + 1
        # Before ``on_up``, which may send a heartbeat: the robot takes nothing before its OK.
        self._client.send(self.words.accept_hello(self.session))
        self._client.greeted()
        self._accepted = True
        _log.info("%s: connected, job program %s", self, hello.job_version)
        self._changed.set()
        self._on_up()

    def _ended(self, fault: LinkError) -> None:
        """The present client is gone or going."""
        _log.warning("%s: %s", self, fault)
        # Cleared before anybody is told: whoever hears of the loss must find the channel closed.
        accepted, self._accepted, self._client = self._accepted, False, None
        if accepted:
            self._on_lost(fault)
        else:
            self._refused = fault
        self._changed.set()

    def _gone(self, client: "_Client", error: Exception | None) -> None:
        # A client that was dropped before is closed later, when the next one may stand already.
        if client is self._client:
            self._ended(LinkLost(f"{self}: {error or 'closed by the robot'}"))


class _Client(asyncio.Protocol):
    """The socket of one caller: bytes in both directions, and its end."""

    def __init__(self, channel: SjlChannel) -> None:
        self.closed = asyncio.Event()
        self._channel = channel
        self._reader = RecordReader()
        self._transport: asyncio.Transport | None = None
        self._hello_timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        # A stranger is dropped before a word is exchanged, so that it cannot take the place of the
        # robot.
        if not self._channel._admit(self, transport.get_extra_info("peername")[0]):
            transport.abort()
            return
        self._transport = transport
        sock = transport.get_extra_info("socket")
        # Without it a small record waits for the acknowledgement of the one before: 42 ms were
        # measured for a stop (docs/decisions/0003).
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        loop = asyncio.get_running_loop()
        fault = ConnectTimeout(f"{self._channel}: no HELLO within {HELLO_TIMEOUT_S:g} s")
        self._hello_timer = loop.call_later(HELLO_TIMEOUT_S, self._channel.drop, fault)

    def data_received(self, data: bytes) -> None:
        _log.debug("%s <- %r", self._channel, data)
        self._reader.feed(data)
        try:
            # A record may have led to the end of the session; those behind it belong to nobody.
            while self._transport is not None and (record := self._reader.next()) is not None:
                self._channel._record(record)
        except ProtocolViolation as fault:
            self._channel.drop(fault)

    def connection_lost(self, exc: Exception | None) -> None:
        self.greeted()
        self._transport = None
        self.closed.set()
        self._channel._gone(self, exc)

    def send(self, line: bytes) -> None:
        _log.debug("%s -> %r", self._channel, line)
        if self._transport is not None:
            self._transport.write(line)

    def greeted(self) -> None:
        if self._hello_timer is not None:
            self._hello_timer.cancel()

    def close(self) -> None:
        self.greeted()
        transport, self._transport = self._transport, None
        if transport is not None:
            transport.close()

    def abort(self) -> None:
        self.greeted()
        transport, self._transport = self._transport, None
        if transport is not None:
            transport.abort()
