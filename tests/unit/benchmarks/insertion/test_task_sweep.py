"""Random tasks: drawn by their seed, within what the cell may be told, and looked through."""

from dataclasses import replace

import pytest

from benchmarks.insertion.cycles import CycleInjection, CycleOutcome
from benchmarks.insertion.random_tasks.tasks import RandomTask, random_task
from benchmarks.insertion.random_tasks.truths import Truth
from benchmarks.insertion.task_sweep import LINE, SweptTask, findings, sweep_task, table
from cellctl.errors.base import CellError
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from fakes.scenes.socket.peaks import ForcePeaks

SEEDS = range(1, 200)
FORCE_N, MOMENT_N_M = 9.0, 0.1


def _drawn() -> list[RandomTask]:
    tasks = []
    for seed in SEEDS:
        try:
            tasks.append(random_task(seed))
        except CellError:
            continue
    return tasks


def test_tasks_are_many_and_those_of_their_seeds() -> None:
    tasks = _drawn()
    assert len(tasks) > len(SEEDS) / 2
    assert {task.truth for task in tasks} >= set(Truth)
    plugs = [task for task in tasks if task.cell.plan.task.fit.outer_radius_m is not None]
    assert 0 < len(plugs) < len(tasks)
    assert any(task.cell.plan.task.fit.keys is not None for task in plugs)
    again = random_task(SEEDS[1])
    assert again.cell.recipe == random_task(SEEDS[1]).cell.recipe
    assert again.cell.scenario == random_task(SEEDS[1]).cell.scenario


def test_the_cell_is_told_the_truth_of_a_task_that_is_as_told() -> None:
    for task in _drawn():
        if task.truth is not Truth.AS_TOLD:
            continue
        wrong = task.injection.world
        assert (wrong.fit, wrong.grip_n, wrong.sensor, task.injection.part) == (None,) * 4
        told, true = task.cell.plan.task, task.cell.scenario
        assert told.cell.stiffness_n_m >= true.compliance.axial_n_m
        assert abs(told.fit.bore_radius_m * 1e3 - true.fit.bore_radius_mm) < 1e-9
        assert told.cell.friction == pytest.approx(true.fit.friction, abs=0.03)


def _outcome(**changes: object) -> CycleOutcome:
    peaks = {
        phase: ForcePeaks(dict.fromkeys((1, 3, 20), FORCE_N), dict.fromkeys((1, 3, 20), MOMENT_N_M))
        for phase in CyclePhase
    }
    outcome = CycleOutcome(1, called_good=True, seated=True, cycle_s=40.0, peaks=peaks)
    for name, value in changes.items():
        setattr(outcome, name, value)
    return outcome


@pytest.fixture
def task() -> RandomTask:
    """With limits that 9 N in all phases keep."""
    drawn = next(task for task in _drawn() if task.cell.plan.task.limits.search_n > 7)
    return replace(drawn, truth=Truth.AS_TOLD, injection=CycleInjection())


def test_a_good_part_has_nothing_that_must_not_happen(task: RandomTask) -> None:
    assert findings(task, _outcome()) == []


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"seated": False}, "called inserted"),
        ({"called_good": False}, "no verdict and no fault"),
        ({"cycle_s": 700.0}, "took 700 s"),
        ({"peaks": {CyclePhase.SEARCH: ForcePeaks({1: 0.0, 3: 0.0, 20: 16.0})}}, "search: force"),
        ({"peaks": {CyclePhase.VERDICT: ForcePeaks({1: 0.0, 3: 300.0, 20: 0.0})}}, "over 3 ms"),
    ],
)
def test_what_must_never_happen_is_found(
    task: RandomTask, changes: dict[str, object], said: str
) -> None:
    (found,) = findings(task, _outcome(**changes))
    assert said in found


def test_a_refused_recipe_is_an_outcome_of_its_own() -> None:
    refused = next(seed for seed in SEEDS if _is_refused(seed))
    swept = sweep_task(refused)
    assert swept.outcome.startswith("refused F")
    assert not swept.found
    assert LINE.read(LINE.written(refused, swept)) == (refused, swept)
    assert table([swept]).row_count == 1


def _is_refused(seed: int) -> bool:
    try:
        random_task(seed)
    except CellError:
        return True
    return False


@pytest.mark.long
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("seed", [3, 7, 8, 11, 16, 24, 30, 2003, 2011, 2053])
def test_nothing_that_must_not_happen_does(seed: int) -> None:
    """Among them those in which it once did."""
    assert sweep_task(seed).found == ()


@pytest.mark.parametrize("seed", [16, pytest.param(24, marks=pytest.mark.figures)])
def test_a_face_that_is_not_as_told_ends_in_a_fault(seed: int) -> None:
    swept = sweep_task(seed)
    assert swept.truth in (Truth.STEEP_FACE.value, Truth.FAR_FACE.value)
    assert swept.outcome in ("F512", "F549")
    assert isinstance(swept, SweptTask)
    assert not swept.found
