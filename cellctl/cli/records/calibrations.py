"""`cellctl calibrations`: what was calibrated, when, with which figures, and what became of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from datetime import datetime
from typing import Annotated, Any

import typer
from rich.table import Table

from cellctl.calibration.checks import RELATIONS
from cellctl.cli.consoles import console_of_tables
from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.clock import utc_now
from cellctl.records.entries import Calibration
from cellctl.spelling import nearest

app = typer.Typer(help="Look into the calibrations of the run store.", no_args_is_help=True)

AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]


@app.command("list")
def list_calibrations(*, as_json: AsJson = False, data_dir: DataDir = None) -> None:
    """The newest calibration of each kind."""
    newest: dict[str, Calibration] = {}
    for one in _kept(data_dir):
        newest.setdefault(one.kind, one)
    found = [newest[kind] for kind in sorted(newest)]
    if as_json:
        _as_json(found)
        return
    if not found:
        typer.echo(
            "no calibrations: none was made by a procedure of this run store. Those that the cell "
            "uses lie in `calibration_dir` of its cell file; `cellctl status` lists them."
        )
        return
    now = utc_now()
    table = Table("kind", "made (UTC)", "valid until", "verdict", "state", "id", box=None)
    for one in found:
        table.add_row(
            one.kind,
            f"{one.made:%Y-%m-%d %H:%M}",
            f"{one.valid_until:%Y-%m-%d}",
            _verdict(one),
            _state(one, now),
            one.id[:12],
        )
    # Reasons hold whatever people have typed: brackets in it are no mark-up.
    console_of_tables().print(table)


@app.command()
def show(
    kind: Annotated[str, typer.Argument(help="Such as head_1, see `cellctl calibrations list`.")],
    *,
    as_json: AsJson = False,
    data_dir: DataDir = None,
) -> None:
    """Every calibration of one kind, oldest first: how its figures move over the years."""
    kept = _kept(data_dir)
    found = [one for one in reversed(kept) if one.kind == kind]
    if not found:
        kinds = sorted({one.kind for one in kept})
        known = f"kinds here: {', '.join(kinds) or 'none'}"
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
    console.print(_figures(found))


def _kept(data_dir: DataDir) -> list[Calibration]:
    """All calibrations, the newest first."""
    with opened_store(data_dir) as store:
        return store.calibrations()


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
