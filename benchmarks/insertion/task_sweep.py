"""Whole cycles on random tasks and truths, looked through for what must never happen.

``python -m benchmarks.insertion.task_sweep -n 200 --out FILE``. Exit code 1 where a part was called
inserted that is not, a force went beyond its limit, a cycle did not end, or something else than a
fault of the cell was raised.
"""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.insertion.cycles import CycleCell, CycleOutcome, run_cycle
from benchmarks.insertion.farmed import Line, exit_code_of, farmed, parser_of
from benchmarks.insertion.random_tasks.tasks import RandomTask, random_task
from benchmarks.insertion.random_tasks.truths import Truth
from benchmarks.insertion.wilson import wilson_bounds
from cellctl.errors.base import CellError
from cellctl.processes.peg_in_hole.offline.curve import parse_curve
from cellctl.processes.peg_in_hole.offline.judge import judge_curve
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force

TRIALS, QUICK_TRIALS = 200, 5
_SEARCH_RATIO = 1.5
"""Multiple of the search force that a 20 ms mean may reach in the search of a task that is as the
cell is told (R3 of the study); in others the guard's limit is all that holds."""
_STANDS_RATIO = 1.05
"""Multiple of the guard's limit: from its trip to its standstill the arm goes on."""
_LONGEST_S = 600.0
_UNSOLVED_SHARE = 0.02
"""A cycle with more steps without an equilibrium says nothing about forces."""


@dataclass(frozen=True, slots=True)
class SweptTask:
    """What came of one task."""

    seed: int
    truth: str
    task: str
    outcome: str
    """`inserted`, a fault, or `refused` with the fault that refuses the recipe."""
    seated: bool = False
    found: tuple[str, ...] = ()
    """What must never happen."""
    cycle_s: float = 0.0
    unsolved_share: float = 0.0


def main() -> int:
    """Exit code."""
    found = parser_of(__doc__, "tasks", TRIALS).parse_args()
    trials = found.n or (QUICK_TRIALS if found.quick else TRIALS)
    jobs = range(found.seed, found.seed + trials)
    swept = farmed(sweep_task, jobs, "tasks", LINE, found)
    console = Console(width=150)
    console.print(table(swept))
    named = ((f"seed {one.seed} ({one.truth}; {one.task})", one.found) for one in swept)
    return exit_code_of(console, named)


def sweep_task(seed: int) -> SweptTask:
    """Run the task of a seed."""
    try:
        drawn = random_task(seed)
    except CellError as fault:
        return SweptTask(seed, "refused", "", f"refused F{fault.number}")
    words = _words(drawn.cell)
    try:
        outcome = run_cycle(drawn.cell, seed, drawn.injection)
    except Exception as error:  # noqa: BLE001 - whatever it is, the sweep looks for it
        raised = f"{type(error).__name__}: {error}"
        return SweptTask(seed, drawn.truth.value, words, "raised", found=(raised,))
    return SweptTask(
        seed,
        drawn.truth.value,
        words,
        "inserted" if outcome.called_good else outcome.fault,
        outcome.seated,
        tuple(findings(drawn, outcome)),
        round(outcome.cycle_s, 1),
        round(outcome.unsolved_share, 4),
    )


def findings(drawn: RandomTask, outcome: CycleOutcome) -> list[str]:
    """What must never happen, in words."""
    found = []
    if outcome.called_good and not outcome.seated:
        found.append(f"called inserted {outcome.height_m * 1e3:.2f} mm over the face")
    if not outcome.called_good and not outcome.fault:
        found.append("no verdict and no fault")
    if not outcome.seated and _by_curve(outcome) == "inserted":
        found.append("its curve is judged as inserted")
    if outcome.cycle_s > _LONGEST_S:
        found.append(f"took {outcome.cycle_s:.0f} s")
    return found + _forces(drawn, outcome)


def _forces(drawn: RandomTask, outcome: CycleOutcome) -> list[str]:
    task = drawn.cell.plan.task
    limits = task.limits
    face_n, searched_n = (
        _STANDS_RATIO * guard_force(task, phase).value
        for phase in (CyclePhase.FACE, CyclePhase.SEARCH)
    )
    if drawn.truth is Truth.AS_TOLD:
        searched_n = _SEARCH_RATIO * limits.search_n
    bounds_n = {
        CyclePhase.FACE: face_n,
        CyclePhase.SEARCH: searched_n,
        CyclePhase.INSERTION: limits.insertion_n,
        CyclePhase.VERDICT: limits.insertion_n,
    }
    found = []
    for phase, peaks in outcome.peaks.items():
        for window_ms, what, felt, bound, unit in (
            (20, "force", peaks.force_n, bounds_n[phase], "N"),
            (3, "force", peaks.force_n, limits.fault_n, "N"),
            (3, "moment", peaks.moment_n_m, limits.fault_n_m, "N·m"),
        ):
            if felt[window_ms] > bound and outcome.unsolved_share < _UNSOLVED_SHARE:
                found.append(
                    f"{phase.value}: {what} over {window_ms} ms {felt[window_ms]:.2f} of "
                    f"{bound:.2f} {unit}"
                )
    return found


def _by_curve(outcome: CycleOutcome) -> str:
    if outcome.part is None or not outcome.curve:
        return ""
    try:
        return judge_curve(parse_curve(outcome.curve.encode()), outcome.part)[1].verdict.value
    except CellError as fault:
        return f"F{fault.number}"


def _words(cell: CycleCell) -> str:
    task = cell.plan.task
    fit, figures, first = task.fit, task.cell, cell.plan.choice.order[0]
    return (
        f"r {fit.peg_radius_m * 1e3:.1f}, c {fit.clearance_m * 1e3:.3f}, chamfers "
        f"{fit.hole_chamfer_m * 1e3:.1f} and {fit.peg_chamfer_m * 1e3:.1f}, depth "
        f"{fit.depth_m * 1e3:.0f}, u {figures.uncertainty_m * 1e3:.1f} mm, k "
        f"{figures.stiffness_n_m:.1e} N/m, {first.value}"
        f"{', plug' if fit.outer_radius_m is not None else ''}"
        f"{', keyed' if fit.keys is not None else ''}"
    )


def _written(_: int, one: SweptTask) -> Mapping[str, Any]:
    return asdict(one)


def _read(record: Mapping[str, Any]) -> tuple[int, SweptTask]:
    return int(record["seed"]), SweptTask(**{**record, "found": tuple(record["found"])})


LINE = Line(_written, _read)


def table(swept: Sequence[SweptTask]) -> Table:
    """A row for each truth; the bounds are Wilson's."""
    shown = Table("truth", "tasks", "inserted", "bounds", "findings", "how it ended", title="Tasks")
    for truth, count in sorted(Counter(one.truth for one in swept).items()):
        some = [one for one in swept if one.truth == truth]
        inserted = sum(one.outcome == "inserted" and one.seated for one in some)
        low, high = wilson_bounds(inserted, count)
        ended = Counter(one.outcome for one in some)
        shown.add_row(
            truth,
            str(count),
            str(inserted),
            f"{100 * low:.0f} to {100 * high:.0f} %",
            str(sum(bool(one.found) for one in some)),
            ", ".join(f"{number} {name}" for name, number in ended.most_common()),
        )
    return shown


if __name__ == "__main__":
    sys.exit(main())
