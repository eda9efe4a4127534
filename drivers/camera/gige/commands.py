"""``cellctl devices``: the cameras that GenTL producers see, with what a cell file needs."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from cellctl.errors.camera import ProducerUnusable
from cellctl.errors.link import LinkError, ReplyTimeout
from drivers.camera.gige.connection import LibraryProcess
from drivers.camera.gige.producer_files import PRODUCER_PATH, producer_files
from drivers.camera.gige.protocol import CamerasSeen, CameraState, ListRequest, SeenCamera

_PANEL = "The cell"
_KEYS = ("serial_number", "user_name", "ip_address", "id")
"""What a cell file may name a camera by."""


def add(app: typer.Typer) -> None:
    """Add the command to a command line."""
    app.command("devices", rich_help_panel=_PANEL)(devices)


def devices(
    producer: Annotated[
        list[Path] | None,
        typer.Option(help=f"Producer of a camera maker (.cti); default: {PRODUCER_PATH}."),
    ] = None,
    timeout_s: Annotated[float, typer.Option(help="For each producer.", min=1.0)] = 20.0,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
) -> None:
    """List the cameras that GenTL producers see; opens none of them."""
    files = producer_files(tuple(producer or ()))
    if not files:
        raise ProducerUnusable(f"none is named, and no folder of {PRODUCER_PATH} holds a .cti")
    seen: list[SeenCamera] = []
    failed: list[LinkError] = []
    for path in files:
        try:
            seen += _seen_by(path, timeout_s)
        except LinkError as error:
            failed.append(error)
    if len(failed) == len(files):
        raise failed[0]
    for fault in failed:
        typer.echo(str(fault), err=True)
    if as_json:
        typer.echo(json.dumps([_plain(one) for one in seen], indent=2, ensure_ascii=False))
        return
    if not seen:
        typer.echo("no camera is seen: look at its power, its cable, its subnet and the firewall")
        return
    # Names of cameras are what people have given them: brackets in them are no mark-up.
    Console(markup=False, emoji=False).print(_table(seen))
    typer.echo(_for_cell_file(seen))


def _seen_by(producer: Path, timeout_s: float) -> tuple[SeenCamera, ...]:
    """Asked in a process of its own: a library that crashes or hangs hides no other."""
    library = LibraryProcess(producer.name)
    library.start()
    try:
        answer, _ = library.ask(ListRequest((producer,)), timeout_s)
    finally:
        library.end()
    if not isinstance(answer, CamerasSeen):
        raise ReplyTimeout(f"{type(answer).__name__} for a list of cameras")
    return answer.cameras


def _plain(camera: SeenCamera) -> dict[str, str]:
    return asdict(camera) | {"producer": str(camera.producer), "state": camera.state.value}


def _table(cameras: list[SeenCamera]) -> Table:
    table = Table(box=None)
    for column in (*_KEYS, "camera", "state", "producer"):
        table.add_column(column, overflow="fold")  # all of it: it is copied from here
    for one in cameras:
        keys = [getattr(one, key) for key in _KEYS]
        name = f"{one.vendor} {one.model}".strip()
        table.add_row(*keys, name, one.state.value, Path(one.producer).name)
    return table


def _for_cell_file(cameras: list[SeenCamera]) -> str:
    """A piece of a cell file that opens: the first free cameras, as single one and as a head."""
    usable = sorted(cameras, key=lambda one: one.state is not CameraState.FREE)
    first = usable[0]
    left, right = (usable * 2)[:2]
    lines = ["", "For a cell file (a name is of small letters, digits and _):", "", "[cameras.eye]"]
    lines += [*_head_of(first), f"settings.camera.{_key(first)}"]
    if right is not left:
        lines += ["", "or both as a stereo head:", "", "[stereo_cameras.head_1]"]
        lines += [
            *_head_of(left, right),
            f"settings.left.{_key(left)}",
            f"settings.right.{_key(right)}",
        ]
    return "\n".join(lines)


def _head_of(*cameras: SeenCamera) -> list[str]:
    files = dict.fromkeys(str(Path(one.producer).resolve()) for one in cameras)
    named = ", ".join(f'"{path}"' for path in files)
    return ['driver = "gige"', f"settings.producers = [{named}]"]


def _key(one: SeenCamera) -> str:
    """What of it names the camera best."""
    keys = ("serial_number", "user_name", "id")
    key = next(key for key in keys if getattr(one, key) or key == "id")
    # Quotes and backslashes in a name are written in TOML as they are in JSON.
    return f"{key} = {json.dumps(getattr(one, key), ensure_ascii=False)}"
