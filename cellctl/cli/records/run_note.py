"""`cellctl runs note`: what nobody measures for the cell, and remarks."""

from typing import Annotated

import typer

from cellctl.cli.os_user import terminal_user
from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.records.entered.notes import add_note, note_words, notes_of
from cellctl.records.entered.said_by import said_by


def note(
    run: Annotated[int, typer.Argument(help="Number of the run.", min=1)],
    *,
    by: Annotated[str, typer.Option(help="Who makes the note.")],
    temperature: Annotated[float | None, typer.Option(help="Of the air, in °C.")] = None,
    humidity: Annotated[float | None, typer.Option(help="Relative, in percent.")] = None,
    pressure: Annotated[float | None, typer.Option(help="Of the air, in hPa.")] = None,
    instrument: Annotated[str, typer.Option(help="What they were read from.")] = "",
    remark: Annotated[str, typer.Option(help="Anything else, in words.")] = "",
    data_dir: DataDir = None,
) -> None:
    """Enter temperature, humidity, pressure or a remark; the newest value counts, all are kept."""
    given = {
        "temperature_deg_c": temperature,
        "humidity_percent": humidity,
        "pressure_hpa": pressure,
    }
    values = {key: value for key, value in given.items() if value is not None}
    with opened_store(data_dir) as store:
        add_note(store, run, terminal_user(), by, values, instrument=instrument, remark=remark)
        notes = notes_of(run, store.audit_log())
        closed = store.run(run).head.result is not None
    if not closed:
        typer.echo(
            f"run {run} is not closed: a daemon is at work on it, or was killed and closes it as "
            "interrupted when it is started again; the note is kept"
        )
    for entry in notes:
        words = note_words(entry)
        typer.echo(f"run {run}: {words} ({said_by(entry)}, {entry.time:%Y-%m-%d %H:%M} UTC)")
