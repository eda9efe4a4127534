"""An event loop in a thread of its own, for fakes that face a blocking driver."""

import asyncio
import threading
from collections.abc import Callable, Coroutine
from types import TracebackType
from typing import Any, Self, TypeVar

Value = TypeVar("Value")
_LIMIT_S = 5.0
_TURNS = 8
"""Turns of a loop. From a client's connection to the first line of the coroutine that serves it
asyncio needs five, and from ``abort`` to the closed socket one."""


class LoopThread:
    """``run`` executes a coroutine there and waits; ``call`` a plain function."""

    def __enter__(self) -> Self:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.run(self._cancel_all())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(_LIMIT_S)
        self._loop.close()

    def run(self, coroutine: Coroutine[Any, Any, Value]) -> Value:
        async def after_what_came_before() -> Value:
            # A server that closes between accepting a connection and serving it leaves its socket
            # open (CPython's `Server._attach` fails then), and the warning hits another test.
            await self._take_turns()
            return await coroutine

        future = asyncio.run_coroutine_threadsafe(after_what_came_before(), self._loop)
        return future.result(_LIMIT_S)

    def call(self, function: Callable[[], Value]) -> Value:
        async def wrapped() -> Value:
            return function()

        return self.run(wrapped())

    @classmethod
    async def _cancel_all(cls) -> None:
        # A task that is cancelled before it began never runs its `finally`, and its socket stays.
        await cls._take_turns()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        await cls._take_turns()

    @staticmethod
    async def _take_turns() -> None:
        for _ in range(_TURNS):
            await asyncio.sleep(0)
