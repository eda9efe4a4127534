"""What the links of the fake box share: the task that sends frames when they are due."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable

from fakes.wire.sri_session import SriSession


class Link(ABC):
    """One started transport."""

    @abstractmethod
    async def stop(self) -> None:
        """Close it and wait until its tasks have ended."""


class Pacer:
    """Sends the frames of one session when they are due."""

    def __init__(
        self,
        session: SriSession,
        clock: Callable[[], float],
        write: Callable[[bytes], bool],
        on_write: Callable[[bytes, float], None] | None,
    ) -> None:
        self.session = session
        self._clock = clock
        self._write = write
        self._on_write = on_write
        self._wake = asyncio.Event()

    def receive(self, data: bytes) -> bytes:
        """Pass client bytes on; returns the replies."""
        replies = self.session.receive(data, self._clock())
        self._wake.set()
        return replies

    async def run(self) -> None:
        """Until cancelled."""
        while True:
            due_s = self.session.due_s
            if due_s is None:
                self._wake.clear()
                await self._wake.wait()
                continue
            await asyncio.sleep(max(0.0, due_s - self._clock()))
            for data in self.session.emit(self._clock()):
                if self._write(data) and self._on_write is not None:
                    self._on_write(data, self._clock())


async def cancel(task: asyncio.Task[None]) -> None:
    """Cancel a task and wait for its end."""
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
