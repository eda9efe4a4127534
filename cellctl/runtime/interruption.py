"""A way to end a step in contact from outside that lets the step leave the contact itself."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

from cellctl.errors import CellError

T = TypeVar("T")


class Interruption:
    """One for each run. A process runs what it wants to be able to leave inside ``unless``.

    Cancelling ends a coroutine with no more than its clean-up, which stops the robot. A step that
    presses on a part may have to do more, such as backing off. It does that in the ``except`` of
    the fault that comes out of ``unless``.
    """

    def __init__(self) -> None:
        self._wanted: asyncio.Future[CellError] | None = None

    def interrupt(self, fault: CellError) -> bool:
        """End what runs by this fault; False when nothing runs that could be left."""
        # The first reason counts; the caller of a second one stops the robots in the ordinary way.
        if self._wanted is None or self._wanted.done():
            return False
        self._wanted.set_result(fault)
        return True

    async def unless(self, work: Coroutine[Any, Any, T]) -> T:
        """Run ``work``; when interrupted, cancel it, wait for its clean-up and raise the fault.

        A fault that ``work`` raised by itself at the same moment is the one that counts.
        """
        wanted = self._wanted = asyncio.get_running_loop().create_future()
        working = asyncio.create_task(work)
        try:
            await asyncio.wait({working, wanted}, return_when=asyncio.FIRST_COMPLETED)
            # The fault of the work itself says more than the interruption: it may be the trip that
            # needs the retreat.
            if wanted.done() and not (working.done() and working.exception()):
                raise wanted.result()
            return working.result()
        finally:
            # Cleared first: whoever asks from here on must hear that nothing is left to be
            # interrupted.
            self._wanted = None
            working.cancel()
            await asyncio.gather(working, return_exceptions=True)
