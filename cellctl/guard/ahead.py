"""A guard process that is begun ahead of its start, so that it loads beside the daemon."""

from collections.abc import Callable

from cellctl.guard.child import GuardChild


class ChildAhead:
    """Makes the processes of one guard, the first of them ahead of its use on request.

    A process that waits has loaded its modules and drivers, and has opened nothing.
    """

    def __init__(self, make: Callable[[], GuardChild]) -> None:
        self._make = make
        self._waiting: GuardChild | None = None

    def begin(self) -> None:
        """Have a process wait. Idempotent."""
        if self._waiting is None:
            self._waiting = self._make()

    def take(self) -> GuardChild:
        """The process that waits; a new one where none does, or where it has died meanwhile."""
        waiting, self._waiting = self._waiting, None
        if waiting is not None and waiting.alive:
            return waiting
        if waiting is not None:
            waiting.close()
        return self._make()

    async def dismiss(self) -> None:
        """End the process that waits. Idempotent."""
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            await waiting.quit()
