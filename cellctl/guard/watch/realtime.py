"""The real-time measures that Linux offers to a process which must react in time.

Each measure may be refused, by missing rights or by a container. That is reported and not fatal: a
guard that is late now and then protects more than a guard that does not start.
"""

import ctypes
import gc
import os
import resource
from collections.abc import Callable

_MCL_CURRENT_AND_FUTURE = 3
"""``MCL_CURRENT | MCL_FUTURE`` of ``sys/mman.h``; the standard library does not name them."""
_FALLBACK_NICE = -15
"""Taken when SCHED_FIFO is refused. Under load the slowest answers then took two to three times as
long, measured at the 99.9th percentile."""


def enter(fifo_priority: int, cpu: int | None, *, lock_memory: bool) -> list[str]:
    """Take all measures; returns those that were not permitted, in words.

    Call it last, with everything allocated. The garbage collector is switched off for good: a
    collection would stop the loop for milliseconds, and what the loop allocates is freed by
    reference counts. ``fifo_priority`` 0 and ``cpu`` None leave scheduler and placement alone.
    """
    # What exists now lives as long as the process. Frozen, it is left out of every later
    # collection, also of one that a library asks for explicitly.
    gc.collect()
    gc.freeze()
    gc.disable()
    degraded: list[str] = []
    if lock_memory:
        # A page that was swapped out costs a disk access at the worst moment.
        degraded += _attempt("memory is not locked", _lock_memory)
    if cpu is not None:
        degraded += _attempt(
            f"not pinned to processor {cpu}", lambda: os.sched_setaffinity(0, {cpu})
        )
    if fifo_priority > 0:
        refused = _attempt("no SCHED_FIFO", lambda: _fifo(fifo_priority))
        if refused:
            refused += _attempt(f"no nice {_FALLBACK_NICE}", _nice)
        degraded += refused
    return degraded


def resident_peak_bytes() -> int:
    """Greatest resident memory of this process."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _attempt(words: str, action: Callable[[], None]) -> list[str]:
    try:
        action()
    except OSError as error:
        return [f"{words}: {error.strerror or error}"]
    return []


def _fifo(priority: int) -> None:
    """Run before all ordinary processes. The threads that connect do not inherit it."""
    # RESET_ON_FORK leaves threads ordinary: one that hangs in a connection attempt at real-time
    # priority could keep the processor from the guard itself.
    policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
    os.sched_setscheduler(0, policy, os.sched_param(priority))


def _nice() -> None:
    os.setpriority(os.PRIO_PROCESS, 0, _FALLBACK_NICE)


def _lock_memory() -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(_MCL_CURRENT_AND_FUTURE) != 0:
        code = ctypes.get_errno()
        raise OSError(code, os.strerror(code))
