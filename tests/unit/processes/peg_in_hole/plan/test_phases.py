"""How hard a contact may become before the guard stops the arm."""

from dataclasses import replace

import pytest

from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force
from tests.unit.processes.peg_in_hole.tasks import pin, plug


@pytest.mark.parametrize(
    ("phase", "pin_n", "plug_n"),
    [
        (CyclePhase.FACE, 28.75, 62.5),
        (CyclePhase.SEARCH, 20.0, 25.0),
        (CyclePhase.INSERTION, 37.5, 100.0),
        (CyclePhase.VERDICT, 37.5, 100.0),
    ],
)
def test_every_phase_has_a_limit_of_its_own(phase: CyclePhase, pin_n: float, plug_n: float) -> None:
    assert guard_force(pin(), phase).value == pytest.approx(pin_n)
    assert guard_force(plug(), phase).value == pytest.approx(plug_n)


@pytest.mark.parametrize("phase", list(CyclePhase))
def test_no_phase_goes_beyond_the_limit_of_the_fault(phase: CyclePhase) -> None:
    task = pin()
    task = replace(task, limits=replace(task.limits, fault_n=9.0))
    limit = guard_force(task, phase)
    assert limit.value == 9.0
    assert limit.inputs["F_fault"] == 9.0
