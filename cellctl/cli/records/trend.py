"""`cellctl runs trend`: a figure over the runs, with limits, capability and a control chart."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated

import typer
from rich.table import Table

from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.records.entries import Verdict
from cellctl.records.figures import Limit
from cellctl.records.trend import CONFIDENCE, Index, Sample, Trend
from cellctl.records.trend import trend as trend_of
from cellctl.spelling import nearest
from cellctl.terminal.consoles import console_of_tables

_WIDTH = 41


def trend(
    key: Annotated[
        str, typer.Argument(help="Key of the figure; without it the keys there are.")
    ] = "",
    *,
    recipe: Annotated[int | None, typer.Option(help="Only runs of this recipe.")] = None,
    limit: Annotated[int, typer.Option(help="How many runs, the newest.", min=2)] = 200,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
    data_dir: DataDir = None,
) -> None:
    """A figure over the finished runs of Production, oldest first.

    Cp and Cpk with their confidence interval, and what a control chart finds: values beyond three
    sigma, eight on one side of the mean, six that rise or fall.
    """
    with opened_store(data_dir) as store:
        known = store.figure_keys()
        if not key:
            _list_keys(known, as_json=as_json)
            return
        samples, unit = store.figure_history(key, recipe, limit)
    if len(samples) < 2:
        typer.echo(_too_few(key, known, len(samples)), err=True)
        raise typer.Exit(1)
    found = trend_of(samples)
    if as_json:
        plain = {"key": key, "unit": unit, "samples": [asdict(one) for one in samples]}
        typer.echo(as_plain(plain | asdict(found)))
        return
    console = console_of_tables()
    console.print(_chart(samples, found, f"{key}, {unit}" if unit else key))
    for line in _words(found, unit):
        console.print(line)
    for signal in found.signals:
        console.print(f"run {signal.run}: {signal.rule}", style="yellow")


def _list_keys(known: Sequence[str], *, as_json: bool) -> None:
    if as_json:
        typer.echo(as_plain(known))
    else:
        typer.echo("\n".join(known) or "no figures: no run of this store has any yet")


def _too_few(key: str, known: Sequence[str], count: int) -> str:
    if key in known:
        return f"{count} runs have the figure {key!r}; a trend needs two"
    return f"no run has a figure {key!r}; {nearest(key, known)}`cellctl runs trend` lists them"


def _chart(samples: list[Sample], found: Trend, title: str) -> Table:
    """One line a run: its value, and where it lies between the control limits."""
    marked = {signal.run for signal in found.signals}
    table = Table("run", "time (UTC)", "value", "limits", "−3σ … +3σ", title=title, box=None)
    for one in samples:
        beyond = Limit(one.lower, one.upper).judge(one.value) is Verdict.FAIL
        limits = " … ".join("–" if x is None else f"{x:g}" for x in (one.lower, one.upper))
        table.add_row(
            str(one.run),
            f"{one.time:%Y-%m-%d %H:%M}",
            f"{one.value:.5g}",
            limits,
            _place(one.value, found),
            style="red" if beyond else "yellow" if one.run in marked else None,
        )
    return table


def _place(value: float, found: Trend) -> str:
    middle = _WIDTH // 2
    width = found.upper_control - found.mean
    off = round((value - found.mean) / width * middle) if width > 0 else 0
    line = ["·"] * _WIDTH
    line[middle] = "|"
    line[max(0, min(_WIDTH - 1, middle + off))] = "●"
    return "".join(line)


def _words(found: Trend, unit: str) -> list[str]:
    spread = f"mean {found.mean:.5g}, sigma {found.sigma:.3g} {unit}".rstrip()
    lines = [f"{found.count} runs: {spread} (from run to run)"]
    for name, index in (("Cp", found.cp), ("Cpk", found.cpk)):
        lines.append(f"{name} {_index(index)}")
    if not found.signals:
        lines.append("the control chart finds no change")
    return lines


def _index(index: Index | None) -> str:
    if index is None:
        return "– (needs limits and ten runs)"
    return f"{index.value:.2f}, {CONFIDENCE:.0%} between {index.low:.2f} and {index.high:.2f}"
