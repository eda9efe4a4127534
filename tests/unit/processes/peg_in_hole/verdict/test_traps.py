"""R4: of pegs that are not inserted none is called inserted."""

import pytest

from cellctl.processes.peg_in_hole.faults import (
    FalseSeat,
    HoleTooWide,
    NotSeated,
    PegNotInserted,
    PegSlipped,
    SensorDead,
)
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from tests.rigs.insertion.traps import PegState, run_trap
from tests.unit.processes.peg_in_hole.tasks import pin, plug

TASKS = (pin(), pin(0.1, chamfer_mm=0.5, stiffness_n_m=1e5), plug())
EXPECTED: dict[PegState, tuple[type[PegNotInserted], ...]] = {
    PegState.ON_FACE: (PegSlipped,),
    PegState.ON_CHAMFER: (PegSlipped,),
    PegState.BLOCKED: (PegSlipped,),
    PegState.WRONG_HOLE: (FalseSeat, HoleTooWide),
    PegState.TOO_DEEP: (NotSeated,),
    PegState.FROZEN: (SensorDead,),
    PegState.WRONG_FACE: (NotSeated,),
}


@pytest.mark.parametrize("state", EXPECTED)
def test_no_trap_is_called_inserted(state: PegState) -> None:
    outcomes = [run_trap(task, state, seed) for task in TASKS for seed in range(50)]
    assert not any(one.judgement.inserted for one in outcomes)
    assert all(isinstance(one.judgement.fault, EXPECTED[state]) for one in outcomes)


@pytest.mark.parametrize("task", TASKS)
def test_an_inserted_peg_is_called_inserted(task: SearchTask) -> None:
    outcomes = [run_trap(task, PegState.INSERTED, seed) for seed in range(50)]
    assert [one.judgement.fault for one in outcomes] == [None] * 50


@pytest.mark.parametrize("state", [PegState.ON_FACE, PegState.ON_CHAMFER, PegState.WRONG_HOLE])
def test_pushes_alone_tell_a_peg_that_is_not_between_its_walls(state: PegState) -> None:
    assert not any(run_trap(task, state, seed).captured for task in TASKS for seed in range(50))


def test_pushes_alone_accept_a_peg_in_a_blocked_hole() -> None:
    """This is why the verdict has an item about slip."""
    assert all(run_trap(pin(), PegState.BLOCKED, seed).captured for seed in range(20))
