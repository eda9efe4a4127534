"""Every fault in every phase: `python -m benchmarks.faults.campaign`.

Exit codes: 0 all as demanded, 1 something is not, 130 interrupted. Results are kept after every
trial, and a campaign that was interrupted goes on where it was. A second one beside it, with
`--from-end`, works towards the first.
"""

import random
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta
from fnmatch import fnmatch
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from benchmarks.faults import table
from benchmarks.faults.bench import LINE_FAILURES, Bench, NotReached
from benchmarks.faults.judgement import judge
from benchmarks.faults.kinds import FAULTS, Fault
from benchmarks.faults.observation import Observation
from benchmarks.faults.phases import PHASES, Phase
from benchmarks.faults.trial import run_trial
from fakes.demo.control import Refused

INTERRUPTED = 130
TRIES = 2
"""A trial whose phase was not reached is tried once more, in a cell of its own."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A cell of the table that can be measured."""

    fault: Fault
    phase: Phase

    @property
    def key(self) -> str:
        """Its name in results and on the command line."""
        return f"{self.fault.key}/{self.phase.key}"


def all_trials() -> list[Trial]:
    """Every cell of the table that has no reason to be left out, phase by phase."""
    return [
        Trial(fault, phase)
        for phase in PHASES
        for fault in FAULTS
        if fault.reason_not(phase) is None
    ]


def chosen(trials: Sequence[Trial], only: Sequence[str], tenth: int | None) -> list[Trial]:
    """Those that match a pattern of ``only``, if there is any; of these the tenth of a seed."""
    found = [
        trial
        for trial in trials
        if not only or any(fnmatch(trial.key, pattern) for pattern in only)
    ]
    if tenth is None:
        return found
    drawn = set(random.Random(tenth).sample(range(len(found)), -(-len(found) // 10)))
    return [trial for index, trial in enumerate(found) if index in drawn]


class Campaign:
    """Tries one cell of the table after the other, on one running fake cell as long as it can."""

    def __init__(self, out: Path, file: Path, seed: int, console: Console) -> None:
        out.mkdir(parents=True, exist_ok=True)
        self._out, self._file, self._seed, self._console = out, file, seed, console
        self._bench: Bench | None = None
        self._benches = 0
        self.results = table.load(file)
        self.not_reached: dict[str, str] = {}

    def run(self, trials: Sequence[Trial]) -> None:
        """Try those that have no result yet; what was measured is kept at any time."""
        waiting = [trial for trial in trials if trial.key not in self.results]
        begun_s = time.monotonic()
        try:
            for done, trial in enumerate(waiting, start=1):
                self.results = table.load(self._file)
                if trial.key in self.results:
                    return  # the campaign that began at the other end has been here
                self._try(trial)
                passed_s = time.monotonic() - begun_s
                left_s = passed_s / done * (len(waiting) - done)
                left = timedelta(seconds=round(left_s))
                self._console.print(f"{done} of {len(waiting)}, {left} to go: {self._told(trial)}")
        finally:
            self._end_bench()

    def _try(self, trial: Trial) -> None:
        for _ in range(TRIES):
            try:
                seen = run_trial(self._bench_for(trial.phase), trial.fault, trial.phase)
            except (NotReached, Refused, *LINE_FAILURES) as error:
                self.not_reached[trial.key] = str(error)[:200] or type(error).__name__
                self._end_bench()
                continue
            self._keep(seen)
            # The next trial would meet what this one has left: a cell that is not itself again.
            if not (seen.idle_again and seen.calibrated):
                self._end_bench()
            return

    def _keep(self, seen: Observation) -> None:
        self.not_reached.pop(seen.key, None)
        self.results = table.add(self._file, seen)

    def _bench_for(self, phase: Phase) -> Bench:
        if phase.fresh and self._bench is not None and not self._bench.fresh:
            self._end_bench()
        if self._bench is None:
            self._benches += 1
            stamp = time.strftime("%Y%m%d-%H%M%S")
            folder = self._out / "cells" / f"{stamp}-{self._benches}"
            self._bench = Bench(folder, self._seed)
        return self._bench

    def _end_bench(self) -> None:
        bench, self._bench = self._bench, None
        if bench is not None:
            bench.close()

    def _told(self, trial: Trial) -> str:
        seen = self.results.get(trial.key)
        if seen is None:
            return f"{trial.key}: NOT REACHED, {self.not_reached.get(trial.key)}"
        return " | ".join([trial.key, *table.row(seen)])


def campaign(  # noqa: PLR0917  # options of the command line
    only: Annotated[
        list[str] | None, typer.Option(help="FAULT/PHASE, with * as in file names; may repeat.")
    ] = None,
    tenth: Annotated[int | None, typer.Option(help="A tenth of the cells, by this seed.")] = None,
    seed: Annotated[int, typer.Option(help="Of the fake cell.")] = 1,
    out: Annotated[Path, typer.Option(help="Folder of the tried cells.")] = Path("runs/faults"),
    page: Annotated[Path | None, typer.Option(help="Where the table goes as Markdown.")] = None,
    from_end: Annotated[  # noqa: FBT002  # a flag of the command line
        bool, typer.Option("--from-end", help="Begin with the last cell, beside another campaign.")
    ] = False,
    list_only: Annotated[  # noqa: FBT002  # a flag of the command line
        bool, typer.Option("--list", help="Only name the cells.")
    ] = False,
) -> None:
    """Try the faults; results are kept as JSON beside the page, which is made of them."""
    console = Console(highlight=False, soft_wrap=True, markup=False)
    trials = chosen(all_trials(), only or [], tenth)
    if from_end:
        trials.reverse()
    if list_only:
        console.print("\n".join(trial.key for trial in trials))
        raise typer.Exit
    page = page or out / "fault-matrix.md"
    work, interrupted = Campaign(out, page.with_suffix(".json"), seed, console), False
    try:
        work.run(trials)
    except KeyboardInterrupt:
        interrupted = True
    page.write_text(table.markdown(work.results), encoding="utf-8")
    code = _summary(console, work, trials)
    raise typer.Exit(INTERRUPTED if interrupted else code)


def _summary(console: Console, work: Campaign, trials: Sequence[Trial]) -> int:
    seen = [work.results[trial.key] for trial in trials if trial.key in work.results]
    wrong = [one for one in seen if not judge(one).passed]
    for one in wrong:
        console.print(f"NOT AS DEMANDED {one.key}: {'; '.join(judge(one).wrong)}")
    for key, why in work.not_reached.items():
        console.print(f"NOT REACHED {key}: {why}")
    console.print(f"{len(seen) - len(wrong)} of {len(trials)} as demanded")
    return 0 if len(seen) - len(wrong) == len(trials) else 1


if __name__ == "__main__":
    typer.run(campaign)
