"""`cellctl calibrations`: what was calibrated, when, with which figures, and what became of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from datetime import datetime
from typing import Annotated, Any

import typer
from rich.table import Column, Table

from cellctl.calibration.checks import RELATIONS
from cellctl.cli.operator.no_end import without_end
from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.clock import utc_now
from cellctl.records.entries import AuditEntry, Calibration
from cellctl.records.procedure_entries import rejected, rejected_kinds
from cellctl.spelling import nearest
from cellctl.terminal.consoles import console_of_lines, console_of_tables, print_hanging

app = typer.Typer(help="Look into the calibrations of the run store.", no_args_is_help=True)

_NONE = (
    "none was made by a procedure of this run store. Those that the cell uses lie in "
    "`calibration_dir` of its cell file; `cellctl status` lists them."
)
AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]


@app.command("list")
def list_calibrations(*, as_json: AsJson = False, data_dir: DataDir = None) -> None:
    """The newest calibration of each kind, and results since then that were rejected."""
    newest: dict[str, Calibration] = {}
    kept, audit = _kept(data_dir)
    for one in kept:
        newest.setdefault(one.kind, one)
    found = [newest[kind] for kind in sorted(newest)]
    if as_json:
        _as_json(found)
        return
    if not found:
        typer.echo(f"no calibrations: {_NONE}")
    else:
        # Reasons hold whatever people have typed: brackets in it are no mark-up.
        console_of_tables().print(_newest(found))
    for kind in sorted(rejected_kinds(audit)):
        since = newest[kind].made if kind in newest else None
        _say_rejected([one for one in rejected(audit, kind) if since is None or one.time > since])


def _newest(found: Sequence[Calibration]) -> Table:
    now = utc_now()
    # Kind and id are what other commands ask for: a terminal of 80 columns cuts neither.
    whole = Column("kind", no_wrap=True), Column("id", no_wrap=True)
    table = Table(whole[0], "made (UTC)", "valid until", "verdict", "state", whole[1], box=None)
    for one in found:
        endless = without_end(one.valid_until, now)
        table.add_row(
            one.kind,
            f"{one.made:%Y-%m-%d %H:%M}",
            "no end" if endless else f"{one.valid_until:%Y-%m-%d}",
            _verdict(one),
            _state(one, now),
            one.id[:12],
        )
    return table


def _say_rejected(entries: Sequence[AuditEntry]) -> None:
    console = console_of_lines()
    for one in entries:
        text = (
            f"rejected, nothing uses it: {one.detail.get('item')} of "
            f"{one.time:%Y-%m-%d %H:%M} UTC, run {one.detail.get('run')}: "
            f"{one.detail.get('reason')}"
        )
        print_hanging(console, text, 2)


@app.command()
def show(
    kind: Annotated[str, typer.Argument(help="Such as head_1, see `cellctl calibrations list`.")],
    *,
    as_json: AsJson = False,
    data_dir: DataDir = None,
) -> None:
    """Every calibration of one kind, oldest first: how its figures move over the years."""
    kept, audit = _kept(data_dir)
    found = [one for one in reversed(kept) if one.kind == kind]
    not_used = rejected(audit, kind)
    if not found and not (not_used and not as_json):
        kinds = sorted({one.kind for one in kept} | rejected_kinds(audit))
        known = f"kinds here: {', '.join(kinds)}" if kinds else _NONE
        typer.echo(f"no calibration of the kind {kind!r}; {nearest(kind, kinds)}{known}", err=True)
        raise typer.Exit(1)
    if as_json:
        _as_json(found)
        return
    console = console_of_tables()
    now = utc_now()
    for one in found:
        by = f", {one.serial_number}" if one.serial_number else ""
        console.print(
            f"{one.made:%Y-%m-%d %H:%M} UTC{by}, {one.software}, id {one.id[:12]}: "
            f"{_verdict(one)}; {_state(one, now)}",
        )
    if found:
        console.print(_figures(found))
    _say_rejected(not_used)


def _kept(data_dir: DataDir) -> tuple[list[Calibration], list[AuditEntry]]:
    """All calibrations, the newest first, and the audit log."""
    with opened_store(data_dir) as store:
        return store.calibrations(), store.audit_log()


def _figures(found: Sequence[Calibration]) -> Table:
    """A line for each checked figure, a column for each calibration, the limit of the newest."""
    table = Table("figure", *(f"{one.made:%Y-%m-%d}" for one in found), "limit", box=None)
    by_name = [dict(_checks(one)) for one in found]
    for name, newest in by_name[-1].items():
        values = [_value(checks.get(name)) for checks in by_name]
        relation = RELATIONS[newest.get("side", "both")]
        table.add_row(name, *values, f"{relation} {newest['limit']:.4g} {newest['unit']}".rstrip())
    return table


def _checks(one: Calibration) -> Iterator[tuple[str, Mapping[str, Any]]]:
    # Some results of older versions, and of other packages, state no figures with limits.
    for check in one.record.get("checks", ()):
        yield check["name"], check


def _value(check: Mapping[str, Any] | None) -> str:
    if check is None:
        return "–"
    return f"{check['value']:.4g}" + ("" if check["passed"] else " beyond")


def _verdict(one: Calibration) -> str:
    passed = [check["passed"] for _, check in _checks(one)]
    if not passed:
        return "no figures"
    return "passed" if all(passed) else "failed"


def _state(one: Calibration, now: datetime) -> str:
    if one.invalidated is not None:
        return f"void since {one.invalidated:%Y-%m-%d %H:%M} UTC: {one.invalidated_reason}"
    return "expired" if one.valid_until < now else "valid by its date"


def _as_json(found: Sequence[Calibration]) -> None:
    typer.echo(as_plain([asdict(one) for one in found]))
