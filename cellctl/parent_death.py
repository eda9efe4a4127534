"""Ends a process with the one that started it, however that came to its end."""

import ctypes
import signal

_PR_SET_PDEATHSIG = 1


def die_with_parent(number: signal.Signals) -> None:
    """Have the kernel send a signal to this process when the one that started it ends.

    Linux ties this to the thread that started the process, in the daemon the one of its event loop.
    Raises ``OSError`` where the kernel refuses.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_PR_SET_PDEATHSIG, int(number), 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl")
