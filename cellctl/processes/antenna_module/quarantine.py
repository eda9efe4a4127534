"""Refuses a module that may have bent pins when its serial number comes again."""

from cellctl.processes.antenna_module.faults.plugging import (
    FORCE_FAULTS,
    ModuleInQuarantine,
    StaleLook,
)
from cellctl.processes.antenna_module.steps import INSERT
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunHead, RunResult
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore

_FORCE = frozenset(fault.number for fault in FORCE_FAULTS)
_MOST_RUNS = 1000
"""Most runs of one serial number that are looked at; they are the newest."""


async def require_not_in_quarantine(recorder: RunRecorder) -> None:
    """Raise ``ModuleInQuarantine`` where an earlier run of this module ended with a force fault, or
    in its insertion without a verdict: an Abort, a Stop, a link that was lost.

    A run without a serial number is not refused: nothing says which module it has.
    """
    store = recorder.store
    head = (await store.do(RunStore.run, recorder.run)).head
    if not head.serial:
        return
    for earlier in await store.do(RunStore.runs, _MOST_RUNS, head.serial):
        if earlier.process != head.process or earlier.number == head.number:
            continue
        if (why := await _ended_by(store, earlier)) is not None:
            raise ModuleInQuarantine(f"{head.serial}: {why} in run {earlier.number}")


async def _ended_by(store: AsyncRunStore, run: RunHead) -> str | None:
    """What pins may have been bent by; None for a run that has bent none."""
    if run.fault_number in _FORCE:
        return f"F{run.fault_number}"
    # A look that is too old ends the step before anything moves.
    if run.result == RunResult.GOOD or run.fault_number == StaleLook.number:
        return None
    phases = (await store.do(RunStore.run, run.number)).phases
    if not phases or phases[-1].number != INSERT.number:
        return None
    return f"{run.result or 'unknown end'} in step {INSERT.number}, {INSERT.label},"
