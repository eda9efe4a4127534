"""An event loop whose clock jumps to the next timer, so that waiting takes no time."""

import asyncio
import selectors
from collections.abc import Coroutine
from typing import Any


class _Instant(selectors.SelectSelector):
    """Returns at once and counts the time that it was asked to wait."""

    waited_s = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        assert timeout is not None, "nothing will ever happen"
        self.waited_s += timeout
        return super().select(0)


class InstantLoop(asyncio.SelectorEventLoop):
    """Its time passes only while everybody waits."""

    def __init__(self) -> None:
        self._instant = _Instant()
        super().__init__(self._instant)

    def time(self) -> float:
        return self._instant.waited_s


def time_s() -> float:
    """The time of the running loop."""
    return asyncio.get_running_loop().time()


def run(work: Coroutine[Any, Any, None]) -> None:
    """Run to the end; arbiters and arms must be on ``time_s``."""
    with asyncio.Runner(loop_factory=InstantLoop) as runner:
        runner.run(work)
