"""Real devices do not share the PC's processors; the fake cell asks for what comes nearest."""

import os

PRIORITY = 20
"""Below the force guard, above everything that computes."""


def stand_apart() -> bool:
    """Run before ordinary processes where permitted; children do not inherit it.

    False when the system refuses: the fake cell then runs like any process and may be late on a
    loaded machine.
    """
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(PRIORITY))
    except OSError:
        return False
    return True
