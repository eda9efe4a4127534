"""Refuses a module that has met a force fault when its serial number comes again."""

from cellctl.processes.antenna_module.faults.plugging import FORCE_FAULTS, ModuleInQuarantine
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore

_MOST_RUNS = 1000
"""Most runs of one serial number that are looked at; they are the newest."""


async def require_not_in_quarantine(recorder: RunRecorder) -> None:
    """Raise ``ModuleInQuarantine`` where an earlier run of this module ended with a force fault.

    A run without a serial number is not refused: nothing says which module it has.
    """
    store, numbers = recorder.store, {fault.number for fault in FORCE_FAULTS}
    head = (await store.do(RunStore.run, recorder.run)).head
    if not head.serial:
        return
    for earlier in await store.do(RunStore.runs, _MOST_RUNS, head.serial):
        met_force = earlier.process == head.process and earlier.fault_number in numbers
        if met_force and earlier.number != head.number:
            raise ModuleInQuarantine(
                f"{head.serial}: F{earlier.fault_number} in run {earlier.number}"
            )
