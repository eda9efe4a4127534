"""The wait for a guard process that opens its sensor and its stop channel."""

import asyncio

from cellctl.errors.base import CellError
from cellctl.errors.force import GuardDied


class AwaitedStart:
    """One start after the other; each is settled once, and what comes later changes nothing."""

    def __init__(self) -> None:
        self.succeeded = False
        """Whether the newest start has succeeded."""
        self._settled: asyncio.Future[None] | None = None

    def begin(self) -> "asyncio.Future[None]":
        """A new start, which has not succeeded yet; ``until`` waits for it."""
        self.succeeded = False
        self._settled = asyncio.get_running_loop().create_future()
        return self._settled

    def settle(self, fault: CellError | None) -> None:
        """End the wait, if somebody still waits: with success, or with this fault."""
        if self._settled is None or self._settled.done():
            return
        if fault is None:
            self.succeeded = True
            self._settled.set_result(None)
        else:
            self._settled.set_exception(fault)

    async def until(self, settled: "asyncio.Future[None]", timeout_s: float) -> None:
        """Wait for a start that was begun; raises its fault, or ``GuardDied``."""
        try:
            async with asyncio.timeout(timeout_s):
                await settled
        except TimeoutError:
            raise GuardDied(f"not ready within {timeout_s:g} s after its start") from None
