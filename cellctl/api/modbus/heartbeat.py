"""The heartbeat of the line PLC: a counter that must change. Any constant value means lost."""

import asyncio
from collections.abc import Callable

_LATE_S = 0.1
"""A timer that fires later than this shows that the event loop itself was held up."""
_GRACE_S = 0.25
"""After such a delay, beats that already wait in the socket get this long to be read."""


class HeartbeatWatch:
    """Missing until the first change, alive while it changes, lost after ``timeout_s`` without.

    Observers of ``on_lost`` are called once at each loss and must not raise.
    """

    def __init__(self, timeout_s: float, on_lost: Callable[[], None]) -> None:
        self._timeout_s = timeout_s
        self.on_lost = [on_lost]
        self._value = 0
        self._timer: asyncio.TimerHandle | None = None
        self._lost = False

    @property
    def alive(self) -> bool:
        """True while the counter changes in time."""
        return self._timer is not None

    @property
    def lost(self) -> bool:
        """True once it was alive and stood still; False again as soon as it changes."""
        return self._lost

    def seen(self, value: int) -> bool:
        """A client has written the counter; True when that ended a silence."""
        if value == self._value:
            return False
        self._value = value
        back = self._timer is None
        if self._timer is not None:
            self._timer.cancel()
        self._lost = False
        self._arm(self._timeout_s)
        return back

    def stop(self) -> None:
        """Watch no longer."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _arm(self, delay_s: float) -> None:
        loop = asyncio.get_running_loop()
        self._timer = loop.call_later(delay_s, self._expired, loop.time() + delay_s)

    def _expired(self, due_s: float) -> None:
        if asyncio.get_running_loop().time() - due_s > _LATE_S:
            # The PLC is not to blame for a delay of this process.
            self._arm(_GRACE_S)
            return
        self._timer = None
        self._lost = True
        for observer in self.on_lost:
            observer()
