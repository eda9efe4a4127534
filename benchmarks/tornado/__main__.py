"""The campaign: `python -m benchmarks.tornado`."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from benchmarks.tornado.cases import ALL, SCALES, Case, cases
from benchmarks.tornado.chart import draw
from benchmarks.tornado.costs import costs
from benchmarks.tornado.ledger import Ledger
from benchmarks.tornado.mating_alone import run_mating
from benchmarks.tornado.outcome import Outcome, Verdict
from benchmarks.tornado.table import document, markdown
from benchmarks.tornado.whole_cell import NoResult, run_cell
from fakes.imperfections import CATALOGUE

INTERRUPTED = 130


def tornado(
    scale: Annotated[
        list[float] | None, typer.Option(min=0, help="Times the realistic size; 1, 2 and 5.")
    ] = None,
    seeds: Annotated[int, typer.Option("-n", min=1, help="Number of seeds of every case.")] = 1,
    only: Annotated[
        list[str] | None, typer.Option(help="This imperfection, or `all`; more than once.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the runs.")] = Path("runs/tornado"),
    page: Annotated[
        Path | None,
        typer.Option(help="Where the table goes as Markdown; its figures and chart beside it."),
    ] = None,
) -> None:
    """Try every imperfection; exit code 1 when the cell called a part good that is not.

    Cases whose figures lie beside the page are not run again, and Ctrl-C keeps what is there.
    """
    if unknown := [name for name in only or () if name not in {*CATALOGUE, ALL}]:
        raise typer.BadParameter(f"no such imperfection: {', '.join(unknown)}")
    console = Console(highlight=False)
    out.mkdir(parents=True, exist_ok=True)
    page = page or out / "tornado.md"
    ledger = Ledger(page.with_suffix(".json"))
    wanted = list(cases(scale or SCALES, range(1, seeds + 1), only or ()))
    code = 0
    try:
        _run_all([case for case in wanted if not ledger.has(case)], ledger, out, console)
    except KeyboardInterrupt:
        console.print("interrupted; the same command goes on from here", style="bold")
        code = INTERRUPTED
    _report(ledger, page, console)
    false = [one for one in ledger.outcomes if one.verdict is Verdict.NOT_NOTICED]
    for one in false:
        console.print(f"NOT NOTICED: {one.case.key}: {one.text}", style="bold red")
    raise typer.Exit(code or (1 if false else 0))


def _run_all(left: Sequence[Case], ledger: Ledger, out: Path, console: Console) -> None:
    begun_s = time.monotonic()
    for number, case in enumerate(left, start=1):
        try:
            outcome = _run(case, out)
        except NoResult as error:
            # This is not kept: nothing is known about the case, and the next call runs it again.
            console.print(f"{case.key}: no result: {error}", style="red")
            continue
        ledger.add(outcome)
        each_s = (time.monotonic() - begun_s) / number
        console.print(
            f"{number} of {len(left)}  {case.key}: {outcome.verdict} in {outcome.wall_s:.0f} s, "
            f"about {each_s * (len(left) - number) / 60:.0f} min to go  {outcome.text}"
        )


def _run(case: Case, out: Path) -> Outcome:
    return run_mating(case) if case.place == "mating" else run_cell(case, out / case.key)


def _report(ledger: Ledger, page: Path, console: Console) -> None:
    found = costs(ledger.outcomes)
    if not found:
        console.print("nothing to compare yet")
        return
    chart = page.parent / "pictures" / "tornado.png"
    chart.parent.mkdir(exist_ok=True)
    draw(found, chart)
    page.write_text(document(found, ledger.outcomes, chart.relative_to(page.parent)), "utf-8")
    console.print(markdown(found), soft_wrap=True)
    console.print(f"table in {page}, figures beside it, chart in {chart}")


if __name__ == "__main__":
    typer.run(tornado)
