"""Runs as people and programs read them on a terminal: lists, and one run in figures."""

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import asdict
from typing import Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from cellctl.cli.records.plain_json import as_plain
from cellctl.records.entered.gauges import (
    for_programs,
    gauge_limits,
    judge_gauge,
    part_verdict,
)
from cellctl.records.entered.notes import note_words, notes_of
from cellctl.records.entered.said_by import gauge_entries, measured_by, said_by
from cellctl.records.entries import AuditEntry, Figure, Gauge, LoopPass, RunHead, RunRecord, Verdict
from cellctl.records.figures import NO_LIMIT, NOT_MEASURED, verdicts
from cellctl.records.outcome import GOOD_ENDS, outcome
from cellctl.records.report.acceptance.faults import fault_box
from cellctl.records.report.acceptance.runs_before import RunBefore, words_of_runs_before
from cellctl.records.report.acceptance.table import limit_text
from cellctl.records.report.acceptance.timeline import during
from cellctl.records.report.text import decimals, duration, fixed, number, quantity
from cellctl.records.required.required_figures import not_measured
from cellctl.terminal.consoles import console_of_tables

_WIDE = 100
"""Columns from which on the list has the name of the process."""
_UNBROKEN = 1000
"""Columns in which every list has its place."""
_VERDICTS = {str(Verdict.PASS): "green", str(Verdict.FAIL): "red", NOT_MEASURED: "red"}
_COLOURS = {"open": "yellow", **dict.fromkeys(GOOD_ENDS, "green")}


def show_record(
    record: RunRecord,
    audit: Sequence[AuditEntry],
    before: Sequence[RunBefore] | None = None,
    *,
    as_json: bool,
) -> None:
    """One run in figures; ``audit``: of the store that holds it; ``before``: earlier runs of its
    part, None where nobody has looked for them."""
    number = record.head.number
    notes, entered = notes_of(number, audit), gauge_entries(number, audit)
    if as_json:
        looked_up = {} if before is None else {"runs_before": before}
        beside: Mapping[str, Sequence[Any]] = {"notes": notes, **looked_up}
        plain = {name: [asdict(one) for one in some] for name, some in beside.items()}
        typer.echo(as_plain(asdict(record) | for_programs(record, audit) | plain))
        return
    console = console_of_tables()
    console.print(run_table([record.head], console))
    if ended := fault_box(record, during(record, audit)):
        # Also a run that a command has ended: by whom, and in which step.
        where = f"step {ended.step}" if record.phases else ended.step
        console.print(f"{ended.text}; {where}", style="red")
    for loop in dict.fromkeys(entry.loop for entry in record.passes):
        console.print(_passes([entry for entry in record.passes if entry.loop == loop]))
    judged = [entry for entry in record.newest_figures.values() if entry.verdict is not None]
    lacking = not_measured(record)
    if judged or lacking:
        said = {**verdicts(record.newest_figures), **{one.key: NOT_MEASURED for one in lacking}}
        console.print(_figures([*judged, *lacking], said))
    for gauge in record.gauge_history:
        console.print(gauge_line(record, gauge, entered))
    if part_verdict(record) != record.head.result:
        console.print("the part is bad: a plug gauge is beyond its limit", style="bold red")
    for line in _said(record, before or (), notes):
        console.print(line)


def _said(
    record: RunRecord, before: Sequence[RunBefore], notes: Sequence[AuditEntry]
) -> Iterator[str]:
    yield from (f"alarm {alarm.text}" for alarm in record.alarms)
    yield from (f"this part before: {said}" for said in words_of_runs_before(before))
    yield from (f"note of {said_by(entry)}: {note_words(entry)}" for entry in notes)


def gauge_line(record: RunRecord, entry: Gauge, entered: Sequence[AuditEntry]) -> str:
    """One entry with who, when, with which gauge, and what it says."""
    verdict = judge_gauge(record, entry)
    required = gauge_limits(record).get(entry.hole, NO_LIMIT)
    limit = "" if required == NO_LIMIT else f", required {limit_text(required, 'mm')}: {verdict}"
    with_gauge = f", gauge {entry.gauge_id}" if entry.gauge_id else ""
    replaced = "" if entry in record.gauges else ", replaced by a later entry"
    return (
        f"pin hole {entry.hole}: gauge {entry.diameter_mm:.2f} mm ({measured_by(entry, entered)})"
        f"{limit}{with_gauge}, {entry.time:%Y-%m-%d %H:%M}{replaced}"
    )


def run_table(runs: Sequence[RunHead], console: Console, spoilt: Set[int] = frozenset()) -> Table:
    """One line a run, as wide as the console; ``spoilt``: runs with a good result and a gauge
    beyond its limit."""
    wide = console.width >= _WIDE
    table = _run_table(runs, spoilt, wide=wide, serial_wide=None)
    unbroken = console.options.update(width=_UNBROKEN)
    if console.measure(table, options=unbroken).maximum <= console.width:
        return table
    # A serial number that is broken is read as another one; the words beside it give way.
    longest = max(len(head.serial) for head in runs)
    return _run_table(runs, spoilt, wide=wide, serial_wide=max(longest, len("serial")))


def _run_table(
    runs: Sequence[RunHead], spoilt: Set[int], *, wide: bool, serial_wide: int | None
) -> Table:
    """With ``serial_wide`` serial numbers have so many columns, and mode and result may break."""
    narrow = serial_wide is not None
    table = Table(box=None, padding=(0, 1, 0, 0) if narrow else (0, 1))
    table.add_column("run", no_wrap=True)
    table.add_column("serial", width=serial_wide, overflow="fold")
    for name in ("recipe", *(("process",) if wide else ())):
        # Folded and not cut: a name that is cut is another one.
        table.add_column(name, overflow="fold")
    for name in ("mode", "started (UTC)", "duration", "result"):
        whole = not narrow or name in ("started (UTC)", "duration")
        table.add_column(name, no_wrap=whole, overflow="ellipsis" if whole else "fold")
    for head in runs:
        table.add_row(*run_row(head, spoilt=head.number in spoilt, wide=wide))
    return table


def run_row(head: RunHead, *, spoilt: bool, wide: bool) -> tuple[str | Text, ...]:
    """The cells of this line."""
    result = outcome(head.mode, head.result, spoilt=spoilt)
    mark = " (sim)" if head.simulated else ""
    return (
        str(head.number),
        head.serial + mark,
        head.recipe_name,
        *((head.process,) if wide else ()),
        head.mode,
        f"{head.started:%Y-%m-%d %H:%M}",
        duration(head.started, head.ended),
        Text(result, style=_COLOURS.get(result, "red")),
    )


def _passes(passes: Sequence[LoopPass]) -> Table:
    last = passes[-1].components
    names = (f"{component.name} {component.unit}".rstrip() for component in last)
    table = Table("pass", *names, "µm", box=None)
    for entry in passes:
        errors = (
            fixed(component.value, decimals(component.unit), signed=True)
            for component in entry.components
        )
        table.add_row(str(entry.number), *errors, fixed(entry.residual_um, 1))
    limits = (f"± {number(component.limit or 0.0)}" for component in last)
    table.add_row("limit", *limits, "", style="dim")
    return table


def _figures(judged: Sequence[Figure], said: Mapping[str, str]) -> Table:
    table = Table("figure", "value", "at least", "at most", "verdict", box=None)
    for entry in judged:
        texts = (quantity(value, entry.unit) for value in (entry.value, entry.lower, entry.upper))
        verdict = said[entry.key]
        style = _VERDICTS.get(verdict, "yellow")
        table.add_row(entry.label, *texts, Text(verdict, style=style))
    return table
