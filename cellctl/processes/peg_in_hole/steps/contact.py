"""The stream of one step in contact, recorded whatever becomes of it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from cellctl.cell.by_touch.frames import ContactFrames
from cellctl.cell.by_touch.motions import ContactMotions
from cellctl.cell.by_touch.opening import streamed_contact
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.run import PegRun
from cellctl.processes.peg_in_hole.tick_log import TickLog


@asynccontextmanager
async def contact(run: PegRun, frames: ContactFrames, name: str) -> AsyncIterator[ContactMotions]:
    """Motions by touch; the ticks become the artefact ``NAME.csv``, also when they end badly."""
    cell, log = run.facts.cell, TickLog()
    try:
        async with streamed_contact(
            cell.cell,
            cell.arm,
            frames,
            run.facts.contact,
            cell.robot.stream_offer().limits,
            observer=log,
        ) as motions:
            yield motions
    finally:
        run.board.update(force_peaks=tuple(log.peaks.tolist()))
        await run.recorder.artefact(keys.ticks(name), log.text().encode(), "text/csv")
