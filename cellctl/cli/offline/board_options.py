"""The options by which a command is told which calibration board was before the camera."""

import json
from pathlib import Path
from typing import Annotated

import typer

from cellctl.calibration.boards.board import CalibrationBoard, Charuco, Circles
from cellctl.calibration.boards.known_board import KnownBoard, known_board_from_record
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM
from cellctl.sealed_json import record_within

BoardSize = Annotated[
    str, typer.Option(help="Inner corners, or circles of a grid, columns x rows, such as 9x6.")
]
SquareSide = Annotated[
    float,
    typer.Option(
        help="Side of a square, or distance of the rows of a grid of circles, mm.",
        min=1.0,
        max=500.0,
    ),
]
CharucoMarkers = Annotated[
    str | None, typer.Option(help="Markers of a ChArUco board, such as 5X5_100.")
]
MarkerSide = Annotated[float | None, typer.Option(help="Side of a ChArUco marker, mm.")]
CircleDiameter = Annotated[
    float | None, typer.Option(help="The board is a grid of circles of this diameter, mm.")
]
Asymmetric = Annotated[
    bool,
    typer.Option(
        "--asymmetric", help="Every second row of circles is moved by half: 4x11 of OpenCV."
    ),
]

KnownBoardFile = Annotated[
    Path | None,
    typer.Option(help="Result of an earlier calibration with this very board, to start from."),
]


def read_known_board(path: Path) -> KnownBoard:
    """The board in the result of a calibration, stored or not; raises ``FileInvalid``."""
    try:
        return known_board_from_record(record_within(json.loads(path.read_bytes())))
    except OSError as error:
        raise FileInvalid(f"{path}: {error.strerror or error}") from error
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        reason = f"missing {error}" if isinstance(error, KeyError) else str(error)
        raise FileInvalid(f"{path} holds no board: {reason}") from error


def board_of(
    size: str,
    square_mm: float,
    charuco: str | None,
    marker_mm: float | None,
    circle_mm: float | None,
    *,
    asymmetric: bool,
) -> CalibrationBoard:
    """The board of the options; raises ``typer.BadParameter``."""
    try:
        columns, rows = (int(part) for part in size.lower().split("x"))
        markers = _markers(charuco, marker_mm, square_mm)
        circles = _circles(circle_mm, asymmetric=asymmetric)
        return CalibrationBoard(columns, rows, square_mm * MM, markers, circles)
    except ValueError as error:
        raise typer.BadParameter(f"board {size!r}: {error}") from error


def _markers(dictionary: str | None, marker_mm: float | None, square_mm: float) -> Charuco | None:
    if dictionary is None:
        if marker_mm is not None:
            raise ValueError("--marker-mm needs --charuco")
        return None
    if marker_mm is None or not 0 < marker_mm < square_mm:
        raise ValueError("--charuco needs --marker-mm below --square-mm")
    return Charuco(dictionary.upper().removeprefix("DICT_"), marker_mm * MM)


def _circles(circle_mm: float | None, *, asymmetric: bool) -> Circles | None:
    if circle_mm is None:
        if asymmetric:
            raise ValueError("--asymmetric needs --circle-mm")
        return None
    return Circles(circle_mm * MM, asymmetric)
