"""An event loop on simulated time: waiting costs nothing, and the world moves while it waits."""

import asyncio
import selectors
from collections.abc import Callable
from typing import Any


class _NoWaiting(selectors.SelectSelector):
    """Passes the time that the loop would have waited to the simulation."""

    def __init__(self, wait: Callable[[float], None]) -> None:
        super().__init__()
        self._wait = wait

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(0)
        if ready:
            return ready
        if timeout is None:
            raise RuntimeError("nothing is scheduled: the simulation would wait for ever")
        if timeout > 0:
            self._wait(timeout)
        return ready


class SimulatedTimeLoop(asyncio.SelectorEventLoop):
    """``time()`` is the simulation's; ``advance(to_s)`` is called before it moves on."""

    def __init__(self, start_s: float, advance: Callable[[float], None]) -> None:
        self._now_s = start_s
        self._advance = advance
        super().__init__(_NoWaiting(self._pass))

    def time(self) -> float:
        return self._now_s

    def _pass(self, duration_s: float) -> None:
        # A little more than asked for, or rounding makes the loop ask for the same again.
        self._now_s += duration_s + 1e-9
        self._advance(self._now_s)


def run_simulated(start_s: float, advance: Callable[[float], None], main: Callable[[], Any]) -> Any:
    """Run a coroutine function to its end on simulated time; ``advance`` drives the world."""
    with asyncio.Runner(loop_factory=lambda: SimulatedTimeLoop(start_s, advance)) as runner:
        return runner.run(main())
