"""``cellctl devices``: the cameras that GenTL producers see, with what a cell file needs."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from cellctl.errors.link import ReplyTimeout
from drivers.camera.gige.config import Acquisition
from drivers.camera.gige.connection import LibraryProcess
from drivers.camera.gige.protocol import CamerasSeen, ListRequest, SeenCamera

_PANEL = "Cell"
_COLUMNS = ("serial_number", "user_name", "id", "vendor", "model", "state")


def add(app: typer.Typer) -> None:
    """Add the command to a command line."""
    app.command("devices", rich_help_panel=_PANEL)(devices)


def devices(
    producer: Annotated[
        list[Path] | None,
        typer.Option(help="Producer of a camera maker (.cti); default: GENICAM_GENTL64_PATH."),
    ] = None,
    timeout_s: Annotated[float, typer.Option(help="For loading and looking.", min=1.0)] = 20.0,
) -> None:
    """List the cameras that GenTL producers see; opens none of them."""
    library = LibraryProcess("devices")
    library.start()
    try:
        answer, _ = library.ask(
            ListRequest(Acquisition(producers=tuple(producer or ()))), timeout_s
        )
    finally:
        library.end()
    if not isinstance(answer, CamerasSeen):
        raise ReplyTimeout(f"{type(answer).__name__} for a list of cameras")
    if not answer.cameras:
        typer.echo("no camera is seen: look at its power, its cable and its subnet")
        return
    Console().print(_table(answer.cameras))
    typer.echo(_for_cell_file(answer.cameras, producer or []))


def _table(cameras: tuple[SeenCamera, ...]) -> Table:
    table = Table(*_COLUMNS, box=None)
    for one in cameras:
        state = "in use" if one.busy else "free"
        table.add_row(one.serial_number, one.user_name, one.id, one.vendor, one.model, state)
    return table


def _for_cell_file(cameras: tuple[SeenCamera, ...], producers: list[Path]) -> str:
    one = cameras[0]
    chosen = ("serial_number", one.serial_number) if one.serial_number else ("id", one.id)
    files = ", ".join(f'"{path.resolve()}"' for path in producers)
    lines = ["", "For a cell file:", "", "[cameras.NAME]", 'driver = "gige"']
    if files:
        lines.append(f"settings.producers = [{files}]")
    lines.append(f'settings.camera.{chosen[0]} = "{chosen[1]}"')
    return "\n".join(lines)
