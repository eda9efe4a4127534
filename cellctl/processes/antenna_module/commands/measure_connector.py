"""``cellctl measure-connector``: a connector, and the gripper's marks, in one image file."""

import json
from pathlib import Path
from typing import Annotated

import typer

from cellctl.calibration.output_file import write_file
from cellctl.errors.config import FileInvalid
from cellctl.errors.vision import VisionError
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.connector.marks import read_marks
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorAmbiguous,
    ConnectorMissing,
    ContactBent,
    ContactHidden,
    ContactMissing,
    MarksMissing,
    PaperMethodRefused,
)
from cellctl.processes.antenna_module.vision.matching import looks_alike_in_mirror
from cellctl.processes.antenna_module.vision.measure import measure_connector
from cellctl.processes.antenna_module.vision.measurement import (
    ConnectorMeasurement,
    Method,
    require_sound,
)
from cellctl.processes.antenna_module.vision.paper_method import measure_by_paper
from cellctl.processes.antenna_module.vision.picture import picture_of
from cellctl.processes.antenna_module.vision.pixels import (
    Channel,
    MeasuredPixels,
    Pixels,
    read_pixels,
)
from cellctl.processes.antenna_module.vision.plane import read_plane
from cellctl.processes.antenna_module.vision.result_file import result_to_json
from cellctl.terminal.consoles import print_refusal, print_warning
from cellctl.vision.camera.single_camera import read_single_camera

_PANEL = "From files, without a cell"
"""Of the help, where the core's commands of this sort stand, too."""
EXIT_REFUSED = 1
EXIT_NOT_SOUND = 3


def add(app: typer.Typer) -> None:
    """Add the command to a command line."""
    app.command("measure-connector", rich_help_panel=_PANEL)(measure)


def measure(  # noqa: PLR0917 - the options of the command
    camera: Annotated[Path, typer.Option(help="Calibration of the camera (JSON).")],
    connector: Annotated[Path, typer.Option(help="Drawing of the connector (TOML).")],
    plane: Annotated[Path, typer.Option(help="The plane of the contacts (JSON).")],
    image: Annotated[Path, typer.Option(help="Image file, 8 bit, grey or colour.")],
    method: Annotated[Method, typer.Option(help="default or paper.")] = "default",
    marks: Annotated[Path | None, typer.Option(help="Drawing of the gripper's marks.")] = None,
    out: Annotated[Path | None, typer.Option(help="Write the result here, not to stdout.")] = None,
    picture: Annotated[Path | None, typer.Option(help="Write an annotated picture (PNG).")] = None,
    pixels: Annotated[Pixels, typer.Option(help="bayer for a raw mosaic RGGB.")] = "auto",
    channel: Annotated[Channel, typer.Option(help="Colour that is measured.")] = "green",
    tolerate: Annotated[int, typer.Option(help="Bad contacts that are only reported.")] = 0,
) -> None:
    """Measure the contacts of a connector in one image.

    Exit code 3 when the connector or one of its contacts is missing, ambiguous, bent or hidden; 1
    for any other reason to refuse. A result with bad contacts is written all the same.
    """
    try:
        files = read_single_camera(camera), read_plane(plane), read_connector(connector)
        drawing = None if marks is None else read_marks(marks)
        seen = read_pixels(image, pixels, channel)
        if method == "paper":
            result = measure_by_paper(seen, *files)
        else:
            result = measure_connector(seen.plane, *files, drawing)
        unseen = _not_seen(files[2])
        _write(result, (*seen.warnings, *unseen), seen, out, picture)
        require_sound(result, tolerated=tolerate)
    except (
        ConnectorMissing,
        ConnectorAmbiguous,
        ContactMissing,
        ContactBent,
        ContactHidden,
        MarksMissing,
        PaperMethodRefused,
    ) as fault:
        print_refusal(fault)
        raise typer.Exit(EXIT_NOT_SOUND) from fault
    except (VisionError, FileInvalid) as fault:
        print_refusal(fault)
        raise typer.Exit(EXIT_REFUSED) from fault


def _not_seen(connector: Connector) -> tuple[str, ...]:
    """What a mistake in the drawing would leave as it is in every picture."""
    if not looks_alike_in_mirror(connector):
        return ()
    return (
        "the contacts look the same in a mirror: no picture shows whether their names run the "
        "right way round; `cellctl check` holds plug and socket of a recipe against each other",
    )


def _write(
    result: ConnectorMeasurement,
    warnings: tuple[str, ...],
    seen: MeasuredPixels,
    out: Path | None,
    picture: Path | None,
) -> None:
    data = result_to_json(result)
    data["warnings"] += list(warnings)
    for words in data["warnings"]:
        print_warning(words)
    text = json.dumps(data, indent=2) + "\n"
    if picture is not None:
        write_file(picture, picture_of(seen.plane, result))
    if out is None:
        typer.echo(text, nl=False)
    else:
        write_file(out, text.encode())
