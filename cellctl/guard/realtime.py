"""What Linux offers a process that must not be late. Each refusal is reported, none is fatal."""

import ctypes
import gc
import os
import resource
import signal
from collections.abc import Callable

_PR_SET_PDEATHSIG = 1
_MCL_CURRENT_AND_FUTURE = 3
_FALLBACK_NICE = -15


def settle(fifo_priority: int, cpu: int | None, *, lock_memory: bool) -> list[str]:
    """Call last, with everything allocated; what was not permitted, in words."""
    gc.collect()
    gc.freeze()
    gc.disable()
    degraded: list[str] = []
    if lock_memory:
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


def die_with_parent() -> None:
    """SIGTERM when the thread that started this process ends; a second line behind the pipe."""
    if _libc().prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl")


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
    """Threads and children do not inherit it."""
    policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
    os.sched_setscheduler(0, policy, os.sched_param(priority))


def _nice() -> None:
    os.setpriority(os.PRIO_PROCESS, 0, _FALLBACK_NICE)


def _lock_memory() -> None:
    if _libc().mlockall(_MCL_CURRENT_AND_FUTURE) != 0:
        code = ctypes.get_errno()
        raise OSError(code, os.strerror(code))


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
