"""What one receiver has still to be told: in order, tried again, and never without end."""

import asyncio
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cellctl import log
from cellctl.clock import now_s
from cellctl.hmi.notifying.senders import Messenger, NotTold

_log = log.get(__name__)


@dataclass(frozen=True, slots=True)
class Retries:
    """How often and how long one message is tried."""

    first_wait_s: float = 1.0
    longest_wait_s: float = 60.0
    keep_s: float = 3600.0
    """Age after which a message is old news."""
    most: int = 100
    """Messages that wait; of more, the oldest are dropped."""


class Outbox:
    """Belongs to one event loop; one receiver that is away holds up no other."""

    def __init__(self, sender: Messenger, retries: Retries | None = None) -> None:
        self._sender = sender
        self._retries = retries or Retries()
        self._waiting: deque[tuple[float, Mapping[str, Any]]] = deque()
        self._filled = asyncio.Event()
        self.dropped = 0
        """Messages that nobody has got."""

    def put(self, message: Mapping[str, Any]) -> None:
        """Keep a message until it is told; returns at once."""
        if len(self._waiting) == self._retries.most:
            self._drop("too many wait")
        self._waiting.append((now_s(), message))
        self._filled.set()

    async def run(self) -> None:
        """Deliver until cancelled."""
        while True:
            await self._filled.wait()
            await self._tell_oldest()
            if not self._waiting:
                self._filled.clear()

    async def _tell_oldest(self) -> None:
        """Try the oldest message until it is told, too old, or dropped for newer ones."""
        retries = self._retries
        wait_s, complained = retries.first_wait_s, False
        put_s, message = oldest = self._waiting[0]
        while self._waiting and self._waiting[0] is oldest:
            try:
                await self._sender.send(message)
            except NotTold as error:
                if now_s() - put_s > retries.keep_s:
                    self._drop(str(error))
                    return
                # Once for a message, and not at every try.
                if not complained:
                    _log.warning("not told yet", to=self._sender.name, reason=str(error))
                complained = True
                await asyncio.sleep(wait_s)
                wait_s = min(2 * wait_s, retries.longest_wait_s)
            else:
                # While it was being sent, newer ones may have pushed it out.
                if self._waiting and self._waiting[0] is oldest:
                    self._waiting.popleft()
                return

    def _drop(self, reason: str) -> None:
        _, message = self._waiting.popleft()
        self.dropped += 1
        _log.error("nobody was told", to=self._sender.name, what=message["event"], reason=reason)
