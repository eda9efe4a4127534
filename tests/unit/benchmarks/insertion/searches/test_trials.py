from dataclasses import replace

from benchmarks.insertion.searches.cases import CASES
from benchmarks.insertion.searches.trials import LIMIT_S, run_search
from cellctl.processes.peg_in_hole.plan.choice import SearchName

CHAMFERED = CASES[12].task


def test_a_seed_gives_the_same_search_again() -> None:
    first, again = (run_search(CHAMFERED, SearchName.SPIRAL, 7) for _ in range(2))
    assert first == again
    assert first.found


def test_a_search_beyond_its_reach_is_not_found() -> None:
    cell = replace(CHAMFERED.cell, uncertainty_m=1e-3)
    near = replace(CHAMFERED, cell=replace(cell, repeatability_m=5e-3))
    outcomes = [run_search(near, SearchName.SPIRAL, seed) for seed in range(10)]
    assert not any(one.false_entry for one in outcomes)
    assert all(one.time_s <= LIMIT_S + 20 for one in outcomes)
