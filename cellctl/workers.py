"""Vision worker processes: long solves and image work stay away from the event loop."""

import asyncio
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from typing import ParamSpec, TypeVar

from cellctl.errors.internal import WorkerDied

P = ParamSpec("P")
R = TypeVar("R")

_DEAF_TO = (signal.SIGINT, signal.SIGHUP)

NICE = 5
"""Added to the niceness of the workers.

Image work fills processors for seconds. The event loop, the force guard and the drivers need them
for moments, but then at once: with this they get about three times the share of a worker. More
would let any other program on the PC double the cycle time.
"""


class VisionWorkers:
    """A small pool of spawned processes of lower priority, with one OpenCV thread each.

    They ignore Ctrl-C: the daemon ends them in its own order. The death of one makes all of them
    useless until ``revive``.
    """

    def __init__(self, count: int = 2) -> None:
        # Read by the workers' numpy: threads of its own cost the small fits seven times the time.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        self._count = count
        self._pool = _pool(count)
        self._broken = False

    async def check(self) -> None:
        """Have a worker answer; raises ``WorkerDied``."""
        await self.run(os.getpid)

    def revive(self) -> None:
        """New workers in the place of those that a death has made useless; else nothing."""
        # A pool whose worker was killed takes no work ever again; the standard library offers no
        # other remedy.
        if self._broken:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool, self._broken = _pool(self._count), False

    async def run(self, function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Run a pure function in a worker; its exceptions come back unchanged.

        Raises ``WorkerDied`` when a worker has died meanwhile or before.
        """
        loop = asyncio.get_running_loop()
        try:
            with _deaf_children():
                done = loop.run_in_executor(self._pool, partial(function, *args, **kwargs))
            return await done
        except BrokenProcessPool as error:
            self._broken = True
            raise WorkerDied("a vision worker ended unexpectedly") from error

    def close(self) -> None:
        """End the workers; work that has not begun is dropped."""
        self._pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _deaf_children() -> Iterator[None]:
    """Ctrl-C does not reach a process that is started inside, whatever it has come to.

    A process inherits the signals that its parent blocks. The pool starts its workers when work is
    handed over, and a worker can only ignore a signal once its interpreter runs: a Ctrl-C before
    that would end it with a traceback.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _DEAF_TO)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _pool(count: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(
        max_workers=count,
        # ``fork`` would copy the daemon with its locks, sockets and event loop into every worker.
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_initialise,
    )


def _initialise() -> None:
    os.nice(NICE)  # before the imports, which compute for a second
    import cv2

    for number in _DEAF_TO:
        signal.signal(number, signal.SIG_IGN)
    # Two workers are the parallelism. Threads inside each made the edge detection slower when
    # measured.
    cv2.setNumThreads(1)
