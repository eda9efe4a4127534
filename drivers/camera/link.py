"""A TCP connection on which one side asks and the other answers: shared by camera drivers."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import TypeVar

from cellctl.errors.link import (
    ConnectTimeout,
    DeviceFault,
    LinkLost,
    ProtocolViolation,
    ReplyTimeout,
)

_log = logging.getLogger(__name__)
Value = TypeVar("Value")
Talk = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[Value]]


class RequestLink:
    """One exchange at a time, each with a time limit.

    Closes itself whenever an exchange does not end as it should, because what comes next would
    belong to nobody. Between ``take_up`` and ``give_up`` the next request connects again.
    """

    def __init__(
        self, peer: str, host: str, port: int, connect_timeout_s: float, limit_bytes: int = 65536
    ) -> None:
        self.peer = f"{peer} {host}:{port}"
        self._address = (host, port)
        self._connect_timeout_s = connect_timeout_s
        self._limit_bytes = limit_bytes
        # One request at a time: with two under way, each would read the other's reply.
        self._lock = asyncio.Lock()
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None
        self._wanted = False

    async def take_up(self, probe: Callable[[], Awaitable[object]]) -> None:
        """Connect, and have ``probe`` see that a server answers; raises what either raises."""
        await self.open()
        self._wanted = True
        try:
            # A connection alone proves nothing: a port forwarder accepts it while no server is
            # there.
            await probe()
        except BaseException:
            await self.give_up()
            raise

    async def give_up(self) -> None:
        """Drop the connection and do not make it again. Idempotent."""
        self._wanted = False
        await self.close()

    async def restore(self) -> bool:
        """Make a lost connection again; True when it had been lost. ``LinkLost`` if not wanted."""
        if not self._wanted:
            raise LinkLost(f"{self.peer} is not connected")
        if self._streams is not None:
            return False
        await self.open()
        return True

    async def open(self) -> None:
        """Connect; ``ConnectTimeout`` when nobody answers. Idempotent."""
        async with self._lock:
            if self._streams is not None:
                return
            host, port = self._address
            try:
                async with asyncio.timeout(self._connect_timeout_s):
                    self._streams = await asyncio.open_connection(
                        host, port, limit=self._limit_bytes
                    )
            # A name that cannot be one, such as "head..local", is refused by its encoding.
            except UnicodeError as error:
                raise ConnectTimeout(f"{self.peer}: {error}") from error
            except OSError as error:  # TimeoutError is one too
                reason = error.strerror or "no answer"
                raise ConnectTimeout(f"{self.peer}: {reason}") from error
            _log.info("%s: connected", self.peer)

    async def close(self) -> None:
        """Drop the connection. Idempotent."""
        streams, self._streams = self._streams, None
        if streams is not None:
            # Not a polite close, which would wait until a hung server has taken what is still to be
            # sent.
            streams[1].transport.abort()
            await asyncio.gather(streams[1].wait_closed(), return_exceptions=True)

    async def exchange(self, talk: Talk[Value], timeout_s: float) -> Value:
        """Let ``talk`` send a request and read its answer; ``ProtocolViolation`` goes through."""
        async with self._lock:
            if self._streams is None:
                raise LinkLost(f"{self.peer} is not connected")
            try:
                async with asyncio.timeout(timeout_s):
                    return await talk(*self._streams)
            except DeviceFault:
                raise  # a whole and proper answer: the connection is fine
            # Also when the caller is cancelled: its reply is still to come, and the next request
            # must not get it.
            except BaseException as error:
                await self.close()
                fault = self._translated(error, timeout_s)
                if fault is None:
                    raise
                raise fault from error

    def _translated(self, error: BaseException, timeout_s: float) -> Exception | None:
        """The numbered fault for what ended an exchange; None for what is passed on as it is."""
        if isinstance(error, TimeoutError):
            return ReplyTimeout(f"{self.peer}: no complete reply within {timeout_s:g} s")
        if isinstance(error, asyncio.LimitOverrunError):
            return ProtocolViolation(f"{self.peer}: line too long")
        if isinstance(error, OSError | EOFError):
            return LinkLost(f"{self.peer}: {error or 'closed'}")
        return None
