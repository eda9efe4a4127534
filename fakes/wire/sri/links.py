"""What the links of the fake box share: the task that sends when something is due."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

Item = TypeVar("Item")
Clock = Callable[[], float]
OnWrite = Callable[[bytes, float], None]
"""Told of every write of stream data and the time just after it, for latency measurements."""


class Link(ABC):
    """One started transport."""

    @abstractmethod
    async def stop(self) -> None:
        """Close it and wait until its tasks have ended."""


class Paced(Protocol[Item]):
    """A session that says when it wants to send."""

    @property
    def due_s(self) -> float | None:
        """Time of the next item; None while there is none."""

    def emit(self, now_s: float) -> list[Item]:
        """Items that are due by now."""


class Pacer(Generic[Item]):
    """Sends the items of one session when they are due. ``write`` says whether it could."""

    def __init__(
        self,
        session: Paced[Item],
        clock: Clock,
        write: Callable[[Item], bool],
        on_sent: Callable[[Item, float], None] | None = None,
    ) -> None:
        self._session = session
        self._clock = clock
        self._write = write
        self._on_sent = on_sent
        self._wake = asyncio.Event()

    def wake(self) -> None:
        """The session may have something due now."""
        self._wake.set()

    async def run(self) -> None:
        """Serve the link until this task is cancelled."""
        while True:
            due_s = self._session.due_s
            if due_s is None:
                self._wake.clear()
                await self._wake.wait()
                continue
            await asyncio.sleep(max(0.0, due_s - self._clock()))
            for item in self._session.emit(self._clock()):
                if self._write(item) and self._on_sent is not None:
                    self._on_sent(item, self._clock())


async def cancel(task: asyncio.Task[None]) -> None:
    """Cancel a task and wait for its end."""
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
