"""Notes when the event loop was held: every sign of life to a robot waits for it."""

import asyncio
import resource
from collections.abc import Callable

from cellctl import log
from cellctl.clock import now_s

_log = log.get(__name__)

PERIOD_S = 0.05
HELD_S = 0.25
"""A robot's dead man waits for a second and more: this is noted long before an arm stops."""


async def watch_loop(
    turn: Callable[[float], None], period_s: float = PERIOD_S, held_s: float = HELD_S
) -> None:
    """Log each turn that took longer than ``held_s``, and what it was spent on; until cancelled.

    ``turn`` is called at each turn with the time in seconds by which it came too late.

    Much processor time means that something computed on the loop. Little of it means that the loop
    waited: for the disk, or for a processor that other programs had.
    """
    while True:
        began_s, before = now_s(), resource.getrusage(resource.RUSAGE_THREAD)
        await asyncio.sleep(period_s)
        took_s, after = now_s() - began_s, resource.getrusage(resource.RUSAGE_THREAD)
        late_s = max(0.0, took_s - period_s)
        turn(late_s)
        if late_s > held_s:
            _log.warning(
                "event loop held",
                seconds=round(took_s, 3),
                computed_s=round(_processor_s(after) - _processor_s(before), 3),
                displaced=after.ru_nivcsw - before.ru_nivcsw,
                page_faults=after.ru_majflt - before.ru_majflt,
            )


def _processor_s(used: resource.struct_rusage) -> float:
    return used.ru_utime + used.ru_stime
