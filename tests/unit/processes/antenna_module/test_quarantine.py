"""A module that has met a force fault is refused when it comes again (F486)."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cellctl.errors.force import ForceLimitExceeded
from cellctl.processes.antenna_module.faults.connector import ContactHidden
from cellctl.processes.antenna_module.faults.plugging import (
    FORCE_FAULTS,
    ModuleInQuarantine,
    PlugBentPin,
    StaleLook,
)
from cellctl.processes.antenna_module.process import AntennaModule
from cellctl.processes.antenna_module.quarantine import require_not_in_quarantine
from cellctl.processes.antenna_module.steps import INSERT, LOCATE_SOCKET, STAND_OFF, VERIFY
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunResult
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from cellctl.runtime.steps import StepSpec
from tests.rigs.sweeps import sweep
from tests.unit.records.conftest import start


@pytest.fixture
def store(tmp_path: Path) -> Iterator[AsyncRunStore]:
    made = AsyncRunStore(tmp_path)
    yield made
    made.close()


def ended(store: RunStore, serial: str, fault_number: int | None, process: str) -> int:
    number = start(store, serial=serial, process=process)
    result = RunResult.GOOD if fault_number is None else RunResult.BAD
    store.close_run(number, result, fault_number=fault_number)
    return number


def left(store: RunStore, result: RunResult, fault: int | None, *steps: StepSpec[Any, Any]) -> int:
    number = start(store, serial="M-7", process=AntennaModule.name)
    for step in steps:
        store.begin_phase(number, step.number, step.label)
    store.close_run(number, result, fault_number=fault)
    return number


async def again(store: AsyncRunStore, serial: str) -> None:
    number = await store.do(lambda real: start(real, serial=serial, process=AntennaModule.name))
    await require_not_in_quarantine(RunRecorder(store, number))


@pytest.mark.parametrize("fault", sorted(fault.number for fault in FORCE_FAULTS))
async def test_a_module_that_met_force_does_not_come_again(
    store: AsyncRunStore, fault: int
) -> None:
    number = await store.do(ended, "M-7", fault, AntennaModule.name)
    # It is not forgotten by a run that ended for another reason, nor by one of another module.
    await store.do(ended, "M-7", ContactHidden.number, AntennaModule.name)
    await store.do(ended, "M-8", None, AntennaModule.name)
    with pytest.raises(ModuleInQuarantine, match=f"M-7: F{fault} in run {number}"):
        await again(store, "M-7")


@pytest.mark.parametrize("result", [one for one in RunResult if one is not RunResult.GOOD])
@pytest.mark.parametrize(
    "fault", sweep((None, ForceLimitExceeded.number), (ForceLimitExceeded.number,))
)
async def test_a_module_whose_insertion_nobody_judged_does_not_come_again(
    store: AsyncRunStore, result: RunResult, fault: int | None
) -> None:
    """The pins may stand on the face of the socket as an operator ends the run."""
    number = await store.do(left, result, fault, STAND_OFF, INSERT)
    with pytest.raises(
        ModuleInQuarantine, match=f"M-7: {result.value} in step 80, insert, in run {number}"
    ):
        await again(store, "M-7")


async def test_a_module_that_touched_no_socket_may_come_again(store: AsyncRunStore) -> None:
    await store.do(left, RunResult.ABORTED, None, LOCATE_SOCKET, STAND_OFF)
    await store.do(left, RunResult.BAD, StaleLook.number, STAND_OFF, INSERT)
    await store.do(left, RunResult.BAD, ContactHidden.number, INSERT, VERIFY)
    await store.do(left, RunResult.GOOD, None, INSERT)
    await store.do(left, RunResult.STOPPED, None)
    await again(store, "M-7")


async def test_others_may_come(store: AsyncRunStore) -> None:
    await store.do(ended, "M-7", PlugBentPin.number, AntennaModule.name)
    await store.do(ended, "M-9", ContactHidden.number, AntennaModule.name)
    await store.do(ended, "", PlugBentPin.number, AntennaModule.name)
    await store.do(ended, "M-10", PlugBentPin.number, "deck-to-frame")
    for serial in ("M-7R1", "M-9", "", "M-10"):
        await again(store, serial)
