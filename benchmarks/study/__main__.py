"""Command line: `cellctl study`, or `python -m benchmarks.study`."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from benchmarks.study.chart import draw
from benchmarks.study.farm_error import FarmError
from benchmarks.study.kinds import KINDS, StudyKind
from benchmarks.study.outcome import StudyOutcome
from benchmarks.study.results import AnotherStudy, StudyResults, present_source
from benchmarks.study.table import tables
from fakes.imperfections import UnknownImperfection, parsed_scale

INTERRUPTED = 130
ABOUT = "; ".join(f"{kind.name}: {kind.about}" for kind in KINDS.values())


class UnknownKind(ValueError):
    """There is no such study; a sentence for the user."""


app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
def study(
    kind: Annotated[str, typer.Argument(help=ABOUT)],
    *,
    n: Annotated[int, typer.Option("-n", min=1, help="How many seeds.")] = 1000,
    first: Annotated[int, typer.Option(min=0, help="First seed.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Folder; default: runs/study-KIND.")] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="tcp://HOST:PORT of Dask; default: this computer's workers.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Of this computer; default: its processors.")
    ] = None,
    imperfection: Annotated[
        list[str] | None, typer.Option(help="NAME=SCALE for every seed; may repeat.")
    ] = None,
) -> None:
    """Run a trial over many seeds, print tables, draw a picture; goes on where it was ended.

    Exit code 1 when a part was called good and is not; other ends are results. Ctrl-C keeps what
    is finished.
    """
    console = Console(highlight=False, width=150)
    complaint = Console(stderr=True, highlight=False, soft_wrap=True, style="red")
    try:
        wanted = Wanted.of(kind, range(first, first + n), out, imperfection or [])
        run = wanted.run(console, scheduler, workers)
    except ModuleNotFoundError as error:
        if error.name not in ("dask", "distributed"):
            raise
        complaint.print("Dask is not installed: pip install 'cellctl[study]'", markup=False)
        raise typer.Exit(1) from None
    except (AnotherStudy, UnknownImperfection, UnknownKind, OSError, FarmError) as error:
        complaint.print(str(error), markup=False)
        raise typer.Exit(1) from None
    raise typer.Exit(run)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the user asked for."""

    kind: StudyKind
    seeds: range
    folder: Path
    scales: Mapping[str, float]

    @classmethod
    def of(
        cls, name: str, seeds: range, out: Path | None, imperfections: Sequence[str]
    ) -> "Wanted":
        """Raises ``UnknownKind``, ``UnknownImperfection``."""
        kind = KINDS.get(name)
        if kind is None:
            raise UnknownKind(f"there is no study {name!r}; there are: {', '.join(KINDS)}")
        if imperfections and not kind.scaled:
            raise UnknownKind(f"{name} draws its own world and scales no imperfection")
        scales = dict(parsed_scale(one) for one in imperfections)
        return cls(kind, seeds, out or Path("runs") / f"study-{name}", scales)

    def run(self, console: Console, scheduler: str | None, workers: int | None) -> int:
        """The exit code; raises ``AnotherStudy``, ``FarmError``, ``ModuleNotFoundError``."""
        from benchmarks.study.farm import farm, run_seeds

        results = StudyResults(self.folder, present_source(self.kind.name, self.scales))
        missing = [seed for seed in self.seeds if not results.has(seed)]
        done = len(self.seeds) - len(missing)
        console.print(f"{done} of {len(self.seeds)} seeds are there, in {self.folder}/")
        interrupted = False
        try:
            if missing:
                with (
                    farm(scheduler, workers or len(os.sched_getaffinity(0))) as client,
                    _progress(console) as progress,
                ):
                    bar = progress.add_task(self.kind.name, total=len(missing))

                    def take(outcome: StudyOutcome) -> None:
                        results.add(outcome)
                        progress.advance(bar)

                    run_seeds(client, self.kind.name, missing, self.scales, take)
        except KeyboardInterrupt:
            interrupted = True
        asked = [one for one in results.outcomes if one.seed in self.seeds]
        if asked:
            self._show(console, asked)
        if interrupted:
            console.print(
                f"interrupted: {len(asked)} of {len(self.seeds)} seeds are kept; the same command "
                "goes on from there"
            )
            return INTERRUPTED
        return 1 if any(one.called_good and not one.good for one in asked) else 0

    def _show(self, console: Console, asked: Sequence[StudyOutcome]) -> None:
        for table in tables(self.kind, asked):
            console.print(table)
        draw(self.kind, asked, self.folder / "study.png")
        console.print(f"picture: {self.folder / 'study.png'}")


def _progress(console: Console) -> Progress:
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    return Progress(*columns, TimeRemainingColumn(), console=console)


if __name__ == "__main__":
    app(prog_name=os.environ.get("STUDY_NAME"))
