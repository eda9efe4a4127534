"""Keeps the force curves of a contact in the record, however the contact ends."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from cellctl import log
from cellctl.errors import CellError
from cellctl.processes.deck_to_frame.mating.result import MatingProgress
from cellctl.processes.deck_to_frame.run import AssemblyRun

_log = log.get(__name__)


@asynccontextmanager
async def curves_kept(run: AssemblyRun) -> AsyncIterator[Callable[[MatingProgress], None]]:
    """Inside, report the progress of contacts here; their curves are kept at the end.

    The curve belongs to the fault that ends a contact; a disk that fails then must not hide it.
    """

    def report(progress: MatingProgress) -> None:
        run.board.update(message=progress.phase.value)
        run.recorder.mating_progress(progress)

    try:
        yield report
    # Also after a cancellation: the curve of a contact that somebody has stopped is what they want
    # to see.
    except BaseException as reason:
        try:
            await _keep(run)
            await run.recorder.peak_of_a_cut_contact(run.recipe.mating.limit_force_n)
        except CellError as second:
            reason.add_note(f"force curve not kept: {second}")
            _log.error("force curve not kept", fault=str(second))
        raise
    await _keep(run)


async def _keep(run: AssemblyRun) -> None:
    run.board.update(force_peaks=run.recorder.force_peaks())
    await run.recorder.force_curves()
