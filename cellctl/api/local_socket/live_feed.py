"""Pushes the live view to whoever follows; the daemon never waits for a reader."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

from cellctl.api.local_socket.live_view import LiveView
from cellctl.runtime.cell_status import CellStatus

FOLLOWERS = 2
"""The page, and the page that takes its place while it is being restarted."""
UNREAD_S = 5.0
"""A browser that takes nothing for this time has gone, or its network is full."""
DESCRIBE_PERIOD_S = 3.0
"""How often files and store are asked. They change by procedures and runs, which take longer."""

Describe = Callable[[], Awaitable[dict[str, Any]]]


class _Mailbox:
    """The newest line of each kind; one that nobody has fetched is replaced."""

    def __init__(self) -> None:
        self._lines: dict[str, bytes] = {}
        self._filled = asyncio.Event()

    def put(self, kind: str, line: bytes) -> None:
        self._lines[kind] = line
        self._filled.set()

    async def take(self) -> bytes:
        await self._filled.wait()
        self._filled.clear()
        lines, self._lines = self._lines, {}
        return b"".join(lines.values())


class LiveFeed:
    """Belongs to the event loop of the daemon. Costs nothing while nobody follows."""

    def __init__(self, view: LiveView, describe: Describe, *, unread_s: float = UNREAD_S) -> None:
        """``describe`` gives the message ``description``; it may wait for files and store."""
        self._view = view
        self._describe = describe
        self._unread_s = unread_s
        self._mailboxes: dict[asyncio.Task[Any], _Mailbox] = {}
        self._describing: asyncio.Task[None] | None = None
        self._described = b""

    def publish(self, status: CellStatus) -> None:
        """Send what the line is shown to the followers, too; called at each tick and each
        change."""
        self._view.look()
        if self._mailboxes:
            line = as_line(self._view.snapshot(status))
            for mailbox in self._mailboxes.values():
                mailbox.put("snapshot", line)

    async def follow(self, writer: asyncio.StreamWriter) -> None:
        """Serve one follower until it hangs up, reads nothing for a while or is replaced.

        Raises ``TimeoutError`` or ``OSError``. Of more than two the oldest has to go: it is most
        likely a page that was restarted.
        """
        task = asyncio.current_task()
        assert task is not None
        if len(self._mailboxes) >= FOLLOWERS:
            # Taken out at once: its own clean-up runs later, and the next follower that comes must
            # not choose it again.
            oldest = next(iter(self._mailboxes))
            del self._mailboxes[oldest]
            oldest.cancel()
        mailbox = self._mailboxes[task] = _Mailbox()
        if self._described:
            mailbox.put("description", self._described)
        if self._describing is None:
            self._describing = asyncio.create_task(self._keep_described(), name="description")
        try:
            while True:
                writer.write(await mailbox.take())
                async with asyncio.timeout(self._unread_s):
                    await writer.drain()
        finally:
            self._mailboxes.pop(task, None)
            if not self._mailboxes:
                self._stop_describing()

    def _stop_describing(self) -> None:
        if self._describing is not None:
            self._describing.cancel()
            self._describing, self._described = None, b""

    async def _keep_described(self) -> None:
        while True:
            line = as_line({"kind": "description", **await self._describe()})
            if line != self._described:
                self._described = line
                for mailbox in self._mailboxes.values():
                    mailbox.put("description", line)
            await asyncio.sleep(DESCRIBE_PERIOD_S)


def as_line(message: dict[str, Any]) -> bytes:
    """One line of JSON; raises ``ValueError`` for NaN, which browsers cannot read."""
    text = json.dumps(message, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    return text.encode() + b"\n"
