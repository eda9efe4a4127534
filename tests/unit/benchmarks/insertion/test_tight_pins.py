"""Pins without chamfers, from the face to the verdict, on the contact model."""

import pytest

from benchmarks.insertion.cycles import run_cycle
from benchmarks.insertion.tight_pins import TIGHT_PINS, tight_pin_cell
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase

_OTHERS = [pytest.param(name, marks=pytest.mark.figures) for name in TIGHT_PINS if name != "b-20um"]


@pytest.mark.parametrize("name", ["b-20um", *_OTHERS])
def test_a_pin_without_chamfers_finds_its_hole_and_goes_in(name: str) -> None:
    cell = tight_pin_cell(name)
    assert cell.plan.choice.order[0] is SearchName.TILTED_VALLEY
    outcome = run_cycle(cell, 2)
    assert outcome.called_good
    assert outcome.seated
    assert outcome.unsolved_share < 0.01
    limits = cell.plan.task.limits
    assert outcome.peak_n(CyclePhase.SEARCH, 3) < limits.fault_n
    assert outcome.peak_n(CyclePhase.INSERTION, 20) < limits.insertion_n
