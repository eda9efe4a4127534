"""The PLC's heartbeat: it must change. A counter that stands still, at any value, is lost."""

import asyncio
from collections.abc import Callable

_LATE_S = 0.1
_GRACE_S = 0.25
"""A loop that was itself held up gives beats that wait in the socket this long to be read."""


class HeartbeatWatch:
    """Missing until the first change, alive while it changes, lost after ``timeout_s`` without."""

    def __init__(self, timeout_s: float, on_lost: Callable[[], None]) -> None:
        self._timeout_s = timeout_s
        self._on_lost = on_lost
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
            self._arm(_GRACE_S)
            return
        self._timer = None
        self._lost = True
        self._on_lost()
