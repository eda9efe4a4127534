"""Priorities of the fake cell's processes: real devices do not share the PC's processors."""

import os

PRIORITY = 20
"""SCHED_FIFO priority of the devices: below the force guard, above everything that computes."""

RENDERER_NICE = 5
"""Added to the niceness of the renderers: about a third of the share of an ordinary process.

A late answer of a fake device looks like a broken link, a late picture costs waiting time. It may
not be late for ever, though: the heads' time limits hold for it, also beside other programs.
"""


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


def give_way() -> None:
    """Let everything that moves or listens run before this process; for renderers."""
    os.nice(RENDERER_NICE)
