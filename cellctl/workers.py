"""Vision worker processes: long solves and image work stay away from the event loop."""

import asyncio
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing import connection
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, ParamSpec, TypeVar

from cellctl.clock import now_s
from cellctl.errors.internal import WorkerDied, WorkerSilent
from cellctl.parent_death import die_with_parent

P = ParamSpec("P")
R = TypeVar("R")

_DEAF_TO = (signal.SIGINT, signal.SIGHUP)

NICE = 5
"""Added to the niceness of the workers.

Image work fills processors for seconds. The event loop, the force guard and the drivers need them
for moments, but then at once: with this they get about three times the share of a worker. More
would let any other program on the PC double the cycle time.
"""


PATIENCE_S = 120.0
"""Nothing that a run waits for takes more than a few seconds on a PC that does nothing else."""
CHECK_S = 20.0
"""Time in which a worker answers whether it is there: it may have to be started first."""
SOLVE_S = 900.0
"""Time for the long solves of calibrations."""
JOIN_S = 1.0
"""Time in which a process that was killed is gone."""
CLOSE_S = 5.0
"""Time that work which has begun gets at the end of the daemon."""


class VisionWorkers:
    """A small pool of spawned processes of lower priority, with one OpenCV thread each.

    They ignore Ctrl-C: the daemon ends them in its own order. The death or the silence of one makes
    all of them useless until ``revive``.
    """

    def __init__(self, count: int = 2, *, close_s: float = CLOSE_S) -> None:
        """``close_s`` is what the end of the daemon leaves to work that has begun."""
        # Read by the workers' numpy: threads of its own cost the small fits seven times the time.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        self._count, self._close_s = count, close_s
        self._pool = _Pool(count)
        self._broken = False

    async def check(self) -> None:
        """Have a worker answer; raises ``WorkerDied`` or ``WorkerSilent``."""
        await self.run_within(CHECK_S, os.getpid)

    def revive(self) -> None:
        """New workers in the place of those that are useless; else nothing."""
        # A pool whose worker was killed takes no work ever again; the standard library offers no
        # other remedy.
        if self._broken:
            self._pool.kill()
            self._pool, self._broken = _Pool(self._count), False

    async def run(self, function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Run a pure function in a worker; its exceptions come back unchanged.

        Raises ``WorkerDied`` when a worker has died meanwhile or before, or cannot be started,
        ``WorkerSilent`` when the result has not come within ``PATIENCE_S``.
        """
        return await self.run_within(PATIENCE_S, function, *args, **kwargs)

    async def run_within(
        self, patience_s: float, function: Callable[P, R], *args: P.args, **kwargs: P.kwargs
    ) -> R:
        """The same with another patience, in which waiting for a free worker counts."""
        if self._broken:
            raise WorkerDied("the vision workers were ended and not yet replaced")
        loop, pool = asyncio.get_running_loop(), self._pool
        try:
            try:
                with _deaf_children():
                    done = loop.run_in_executor(pool.executor, partial(function, *args, **kwargs))
            except OSError as error:
                # The executor keeps the work, and would do it for nobody with the next worker.
                self._is_useless(pool)
                raise WorkerDied(f"a vision worker cannot be started: {error}") from error
            if await _comes(done, patience_s):
                return done.result()
        except BrokenProcessPool as error:
            self._is_useless(pool)
            raise WorkerDied("a vision worker ended unexpectedly") from error
        # A process that is suspended or hangs in native code listens to nothing but this.
        self._is_useless(pool)
        pool.kill()
        raise WorkerSilent(f"no result of {function.__name__} within {patience_s:g} s")

    def _is_useless(self, pool: "_Pool") -> None:
        # Whoever waited for an earlier pool may learn of its end when new workers are in place.
        self._broken = self._broken or pool is self._pool

    def close(self) -> None:
        """End the workers; work that has not begun is dropped, that which hangs is ended."""
        self._pool.close(self._close_s)


class _Pool:
    """An executor and its processes, which it does not show itself."""

    def __init__(self, count: int) -> None:
        # Spawned: ``fork`` would copy the daemon with its locks, sockets and event loop.
        self._context = context = _NotingContext()
        self.executor = ProcessPoolExecutor(
            max_workers=count, mp_context=context, initializer=_initialise
        )

    def kill(self) -> None:
        """End the processes, whatever they do; who waits for them gets ``BrokenProcessPool``."""
        # No `shutdown` of the executor here: since Python 3.13 it waits for a lock that the
        # executor holds while it waits for the very processes that hang.
        processes = self._context.started
        for process in processes:
            process.kill()
        for process in processes:
            # A killed process lasts for moments, a suspended one too. One that the kernel does not
            # let go, in a call to a dead disk, is left behind: the event loop must not wait for it.
            process.join(JOIN_S)

    def close(self, patience_s: float) -> None:
        """Let the workers end what they have begun, for at most ``patience_s`` altogether."""
        self.executor.shutdown(wait=False, cancel_futures=True)
        give_up_s = now_s() + patience_s
        running = [process.sentinel for process in self._context.started]
        while running and now_s() < give_up_s:
            ended = connection.wait(running, give_up_s - now_s())
            running = [sentinel for sentinel in running if sentinel not in ended]
        self.kill()


class _NotingContext(SpawnContext):
    """Starts processes as usual and remembers them."""

    def __init__(self) -> None:
        super().__init__()
        self._processes: list[SpawnProcess] = []

    @property
    def started(self) -> list[SpawnProcess]:
        """Processes that run; those whose start has failed need no end and no wait."""
        return [process for process in self._processes if process.pid is not None]

    def Process(self, *args: Any, **kwargs: Any) -> SpawnProcess:  # type: ignore[override]
        process = SpawnProcess(*args, **kwargs)
        self._processes.append(process)
        return process


async def _comes(done: asyncio.Future[R], patience_s: float) -> bool:
    """Wait for a result; one that does not come, or that nobody waits for any more, is dropped."""
    try:
        finished, _ = await asyncio.wait({done}, timeout=patience_s)
    except asyncio.CancelledError:
        done.cancel()
        raise
    if not finished:
        done.cancel()
    return bool(finished)


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


def _initialise() -> None:
    # A worker notices a daemon that was killed only when it has ended its work, which may take
    # long, and a new daemon needs the processors. A worker holds nothing that could be lost.
    die_with_parent(signal.SIGKILL)
    os.nice(NICE)  # before the imports, which compute for a second
    import cv2

    for number in _DEAF_TO:
        signal.signal(number, signal.SIG_IGN)
    # Two workers are the parallelism. Threads inside each made the edge detection slower when
    # measured.
    cv2.setNumThreads(1)
