"""The PLC's heartbeat: it must change. A counter that stands still, at any value, is lost."""

import asyncio
from collections.abc import Callable


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
        self._timer = asyncio.get_running_loop().call_later(self._timeout_s, self._expired)
        return back

    def stop(self) -> None:
        """Watch no longer."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _expired(self) -> None:
        self._timer = None
        self._lost = True
        self._on_lost()
