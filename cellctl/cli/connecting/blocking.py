"""Blocking drivers beside the event loop: those of the guard process, which has none."""

import asyncio
import threading
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")
V = TypeVar("V")
END_S = 2.0
"""What a blocking call may take to end after Ctrl-C; one that waits for a robot takes longer, and
then ends with the program."""


async def in_thread(work: Callable[[threading.Event], T]) -> T:
    """What ``work`` returns or raises; the event is set when nobody waits for it any more."""
    loop = asyncio.get_running_loop()
    done: asyncio.Future[T] = loop.create_future()
    ended = threading.Event()

    def run() -> None:
        try:
            result = work(ended)
        except Exception as error:  # noqa: BLE001 - it belongs to whoever waits
            tell(done.set_exception, error)
        else:
            tell(done.set_result, result)

    def tell(how: Callable[[V], None], what: V) -> None:
        try:
            loop.call_soon_threadsafe(how, what)
        except RuntimeError:
            return  # the loop is closed: the program ends and nobody waits

    # Not of the loop's own pool, for whose threads a program waits at its end.
    threading.Thread(target=run, daemon=True).start()
    try:
        await asyncio.wait({done})
    except asyncio.CancelledError:
        ended.set()
        await asyncio.wait({done}, timeout=END_S)
        if done.done():
            done.exception()  # seen: its caller has gone
        raise
    return done.result()
