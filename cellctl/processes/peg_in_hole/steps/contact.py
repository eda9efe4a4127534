"""The stream of one step in contact, recorded whatever becomes of it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.contact_motion.opening import open_contact_loop, watch_closer
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.cell.contact_motion.ticks import Observers
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.live_figures import LiveFigures
from cellctl.processes.peg_in_hole.record.tick_log import TickLog
from cellctl.processes.peg_in_hole.run import PegRun


@asynccontextmanager
async def contact(run: PegRun, frames: ContactFrames, name: str) -> AsyncIterator[StreamedContact]:
    """Motions by touch; the ticks become the artefact ``NAME.csv``, also when they end badly."""
    async with recorded_loop(run, frames, name) as loop:
        yield StreamedContact(loop)


@asynccontextmanager
async def recorded_loop(
    run: PegRun, frames: ContactFrames, name: str
) -> AsyncIterator[ContactLoop]:
    """The same without motions, for what sends its setpoints itself."""
    cell, log = run.facts.cell, TickLog()
    live = LiveFigures(run.board, run.facts.plan.task.fit.depth_m)
    try:
        async with open_contact_loop(
            cell.cell,
            cell.arm,
            frames,
            run.facts.contact,
            cell.robot.stream_offer().limits,
            observer=Observers(log, live),
        ) as loop:
            yield loop
    finally:
        run.board.update(force_peaks=tuple(log.peaks.tolist()))
        await run.recorder.artefact(keys.ticks(name), log.text().encode(), "text/csv")


async def watch_phase(run: PegRun, motions: StreamedContact, phase: CyclePhase) -> None:
    """Have the guard watch the limits of a phase; the arm stands in its stream meanwhile."""
    task = run.facts.plan.task
    tolerance = WrenchTolerance(guard_force(task, phase).value, task.limits.fault_n_m)
    run.board.update(force_limit_n=tolerance.force_n)
    await watch_closer(motions, run.facts.cell.arm, tolerance)
