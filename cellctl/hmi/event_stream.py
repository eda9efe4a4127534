"""The live view as server-sent events: each browser gets the newest, and never a backlog."""

from collections.abc import AsyncIterator

from cellctl.hmi.hub import Hub
from cellctl.hmi.problems import Problem

BEAT_S = 1.0
STREAMS = 60
STREAMS_EACH = 4
"""Most streams of one session: browsers open no more than six connections to one address, and the
page needs some besides."""


class Streams:
    """How many there are, by whom."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._open: dict[str, int] = {}

    @property
    def count(self) -> int:
        """Number of all streams that are open."""
        return sum(self._open.values())

    def admit(self, key: str) -> None:
        """Count one in; raises ``Problem`` 429 when there are too many."""
        if self._open.get(key, 0) >= STREAMS_EACH:
            raise Problem(429, "tabs", f"more than {STREAMS_EACH} pages are open here").later(5)
        if self.count >= STREAMS:
            raise Problem(429, "full", f"more than {STREAMS} pages are open").later(5)
        self._open[key] = self._open.get(key, 0) + 1

    async def events(self, key: str) -> AsyncIterator[bytes]:
        """What an admitted client is sent, until it goes.

        While a client takes nothing this waits where it is, and goes on with the newest: what was
        missed meanwhile is old.
        """
        version = 0
        try:
            # How long a browser waits before it connects again by itself, in ms.
            yield b"retry: 1000\n\n"
            while True:
                # The beat makes the write to a client fail that has gone without a word.
                lines = self._hub.since(version) or [("beat", b"{}")]
                version = self._hub.version
                yield b"".join(b"event: %s\ndata: %s\n\n" % (k.encode(), v) for k, v in lines)
                await self._hub.wait(version, BEAT_S)
        finally:
            self._open[key] -= 1
            if not self._open[key]:
                del self._open[key]
