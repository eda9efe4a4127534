"""The connections to the daemon: one that follows it, one for each command."""

import asyncio
from pathlib import Path

from cellctl import log
from cellctl.api.local_socket.messages import (
    ANSWER_LIMIT,
    Answer,
    FollowRequest,
    PageCommand,
    parse_answer,
    to_line,
)
from cellctl.errors.local import DaemonNotReached, MessageMalformed
from cellctl.hmi.hub import Hub

RETRY_S = 0.5
SILENT_S = 3.0
"""The daemon sends ten snapshots a second; one that sends none is asked anew."""
ANSWER_S = 10.0

_LOST = (OSError, EOFError, TimeoutError, asyncio.LimitOverrunError)
"""How a connection ends; the last one with a line that is longer than any of the daemon's."""

_log = log.get(__name__)


class AnswerMissing(Exception):
    """The command went out and no answer came: the cell may have taken it, or not."""


class DaemonLink:
    """Belongs to one event loop."""

    def __init__(self, path: Path, hub: Hub, *, answer_s: float = ANSWER_S) -> None:
        """``answer_s``: how long the answer to a command is waited for."""
        self._path = path
        self._hub = hub
        self._answer_s = answer_s

    async def follow(self) -> None:
        """Feed the hub until cancelled; a daemon that is away is tried again and again."""
        while True:
            try:
                await self._follow()
            except (*_LOST, ValueError) as error:
                # Once, and not at every try: a daemon may be away for a night.
                if self._hub.linked:
                    _log.warning("daemon lost", reason=type(error).__name__)
            await self._hub.set_linked(linked=False)
            await asyncio.sleep(RETRY_S)

    async def _follow(self) -> None:
        reader, writer = await asyncio.open_unix_connection(str(self._path), limit=ANSWER_LIMIT)
        try:
            writer.write(to_line(FollowRequest()))
            while True:
                async with asyncio.timeout(SILENT_S):
                    line = await reader.readuntil()
                await self._hub.take(line)
                if not self._hub.linked:
                    # Only after the first line: a socket that accepts and says nothing is no
                    # daemon.
                    await self._hub.set_linked(linked=True)
        finally:
            writer.transport.abort()

    async def ask(self, command: PageCommand) -> Answer:
        """Bring a command; raises ``DaemonNotReached`` when it did not even go out.

        Raises ``AnswerMissing`` when nobody knows whether it was taken. The same command with the
        same key may then be sent again: the daemon obeys it once.
        """
        try:
            reader, writer = await asyncio.open_unix_connection(str(self._path), limit=ANSWER_LIMIT)
        except OSError as error:
            raise DaemonNotReached(f"{self._path}: {error.strerror or error}") from error
        try:
            writer.write(to_line(command))
            async with asyncio.timeout(self._answer_s):
                return parse_answer(await reader.readuntil())
        except (*_LOST, MessageMalformed) as error:
            # Also an answer that this page cannot read: the daemon did something before it gave it.
            raise AnswerMissing from error
        finally:
            writer.transport.abort()
