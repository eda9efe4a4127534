"""Standing in the stream while something else is done, such as a record that goes to the disk."""

import asyncio
from collections.abc import Coroutine
from typing import Any

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.ticks import MotionKind
from cellctl.clock import now_s
from cellctl.errors.streamed_contact import HeldTooLong

HOLD_S = 30.0
"""Longest work beside a standing stream, far above what any takes: only work that hangs is
ended."""


async def hold_while(loop: ContactLoop, work: Coroutine[Any, Any, None], limit_s: float) -> None:
    """Raises what the work or the stream raises, or ``HeldTooLong`` after ``limit_s``."""
    loop.begin_motion(MotionKind.HOLD)
    task = asyncio.create_task(work)
    end_s = now_s() + limit_s
    try:
        while not task.done():
            if now_s() > end_s:
                raise HeldTooLong(f"after {limit_s:g} s")
            await loop.send(loop.tip_command)
            # A stream whose ticks are all there already never waits, and the work would not get
            # its turn.
            await asyncio.sleep(0)
        await task
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
