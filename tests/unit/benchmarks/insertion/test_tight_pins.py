"""Pins without chamfers, from the face to the verdict, on the contact model."""

import pytest

from benchmarks.insertion.cycles import run_cycle
from benchmarks.insertion.tight_pins import TIGHT_PINS, tight_pin_cell
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase


# `test_insert_peg.py` has a whole cycle, `test_strategies.py` the search of these pins.
@pytest.mark.figures
@pytest.mark.parametrize("name", TIGHT_PINS)
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
