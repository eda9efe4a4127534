"""An event loop that does not wait: when nothing is left to do, its time jumps to the next timer.

For programs whose both ends live in one process and talk over loopback, where the bytes of one turn
of the loop are there in the next. Hours of time-outs and motions pass in minutes, and times are
exact, whatever else the PC does.
"""

import asyncio
import os
import selectors
import time
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar
from unittest import mock

T = TypeVar("T")
_LOOKS = 3
"""How often the sockets are asked before time jumps: the kernel hands loopback over at once, or as
soon as this thread lets it."""


class _JumpingSelector(selectors.DefaultSelector):
    """Asks the sockets without waiting, and tells how long it would have waited."""

    def __init__(self, jump: Callable[[float], None]) -> None:
        super().__init__()
        self._jump = jump

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Select as every selector does; without a timer it really waits."""
        for _ in range(_LOOKS):
            if (events := super().select(0)) or timeout == 0:
                return events
            os.sched_yield()
        if timeout is None:
            return super().select(None)
        self._jump(timeout)
        return []


class QuickTime:
    """A monotonic clock that is set forward in place of waiting."""

    def __init__(self) -> None:
        self.now_s = time.monotonic()
        self._clock_gettime = time.clock_gettime

    def run(self, main: Coroutine[Any, Any, T]) -> T:
        """Run to its end; every monotonic clock of this process is this one meanwhile."""
        clocks = mock.patch.multiple(
            time, monotonic=lambda: self.now_s, clock_gettime=self._gettime
        )
        with clocks, asyncio.Runner(loop_factory=self._loop) as runner:
            return runner.run(main)

    def _loop(self) -> asyncio.AbstractEventLoop:
        return asyncio.SelectorEventLoop(_JumpingSelector(self._jump))

    def _jump(self, seconds: float) -> None:
        # A little more, or rounding would leave the timer due in no time, for ever.
        self.now_s += max(seconds, 0.0) + 1e-6

    def _gettime(self, clock: int) -> float:
        return self.now_s if clock == time.CLOCK_MONOTONIC else self._clock_gettime(clock)
