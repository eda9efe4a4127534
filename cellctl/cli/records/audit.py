"""`cellctl audit`: who did what, from the audit log of the run store."""

from dataclasses import asdict
from typing import Annotated

import typer
from rich.table import Table

from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.records.entries import AuditEntry
from cellctl.terminal.consoles import console_of_tables


def audit(
    *,
    data_dir: DataDir = None,
    who: Annotated[str, typer.Option(help="Only whose name holds this text.")] = "",
    action: Annotated[str, typer.Option(help="Only this action, for example gauge.")] = "",
    limit: Annotated[int, typer.Option(help="How many, newest first.", min=1)] = 50,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
) -> None:
    """Who did what: commands, gauges, acknowledgements; every entry is sealed."""
    with opened_store(data_dir) as store:
        log = store.audit_log()
    found = [
        entry for entry in reversed(log) if who in entry.actor and action in ("", entry.action)
    ][:limit]
    if as_json:
        typer.echo(as_plain([asdict(entry) for entry in found]))
    elif found:
        # Details hold whatever people have typed: brackets in it are no mark-up.
        console_of_tables().print(_table(found))
    else:
        typer.echo(f"no such entries, of {len(log)}")


def _table(entries: list[AuditEntry]) -> Table:
    table = Table("time (UTC)", "who", "action", "detail", box=None)
    for entry in entries:
        detail = ", ".join(f"{key} {value}" for key, value in entry.detail.items())
        table.add_row(f"{entry.time:%Y-%m-%d %H:%M:%S}", entry.actor, entry.action, detail)
    return table
