"""The newest snapshot of the cell, for everybody who looks at the page."""

import asyncio
import json
from collections import deque
from typing import Any

from cellctl.clock import now_s

CURVE_S = 60.0


class Hub:
    """Keeps lines as the daemon sent them: they are encoded once, whoever many look on."""

    def __init__(self) -> None:
        self.snapshot: dict[str, Any] = {}
        """Empty until the daemon was reached."""
        self.description: dict[str, Any] = {}
        self.linked = False
        """The connection to the daemon stands."""
        self.version = 0
        """Counts what has come."""
        self._lines: dict[str, tuple[int, bytes]] = {}
        self._curve: deque[tuple[float, list[float | None]]] = deque()
        self._changed = asyncio.Condition()

    async def take(self, line: bytes) -> None:
        """A line of the daemon; raises ``ValueError`` for one that is no message."""
        message = json.loads(line)
        kind = message.get("kind") if isinstance(message, dict) else None
        if kind == "snapshot":
            try:
                self._remember(message)
            except (KeyError, TypeError) as error:
                # Of a daemon of another version. Kept, it would fail whoever asks for its age.
                raise ValueError("a snapshot without what the page needs of it") from error
            self.snapshot = message
        elif kind == "description":
            self.description = message
        else:
            raise ValueError("neither snapshot nor description")
        await self._put(kind, line.rstrip(b"\n"))

    async def set_linked(self, *, linked: bool) -> None:
        """The connection to the daemon has come or gone."""
        self.linked = linked
        await self._put("link", b'{"linked":%s}' % (b"true" if linked else b"false"))

    def since(self, version: int) -> list[tuple[str, bytes]]:
        """The newest line of each kind that came after a version."""
        return [(kind, line) for kind, (number, line) in self._lines.items() if number > version]

    async def wait(self, version: int, timeout_s: float) -> None:
        """Until something newer than the version has come, or the time is over."""
        try:
            async with asyncio.timeout(timeout_s), self._changed:
                await self._changed.wait_for(lambda: self.version > version)
        except TimeoutError:
            return

    @property
    def age_s(self) -> float | None:
        """Age of the newest snapshot; None when there is none."""
        return now_s() - self.snapshot["mono_s"] if self.snapshot else None

    @property
    def curve(self) -> list[tuple[float, list[float | None]]]:
        """The last minute: monotonic time in s, and Fz in N of each force sensor."""
        return list(self._curve)

    async def _put(self, kind: str, line: bytes) -> None:
        self.version += 1
        self._lines[kind] = self.version, line
        async with self._changed:
            self._changed.notify_all()

    def _remember(self, snapshot: dict[str, Any]) -> None:
        values = [
            next((axis["value"] for axis in force["wrench"] if axis["axis"] == "Fz"), None)
            for force in snapshot["forces"]
        ]
        oldest_s = snapshot["mono_s"] - CURVE_S
        self._curve.append((snapshot["mono_s"], values))
        while self._curve[0][0] < oldest_s:
            self._curve.popleft()
