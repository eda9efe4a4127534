"""A calibration board as plain data of a record."""

from collections.abc import Mapping
from typing import Any

from cellctl.calibration.boards.board import CalibrationBoard, Charuco
from cellctl.geometry.pose import MM


def board_to_record(board: CalibrationBoard) -> dict[str, Any]:
    """Plain data."""
    charuco = board.charuco
    return {
        "inner_corners": [board.columns, board.rows],
        "square_mm": board.square_m / MM,
        "charuco_dictionary": None if charuco is None else charuco.dictionary,
        "charuco_marker_mm": None if charuco is None else charuco.marker_m / MM,
    }


def board_from_record(record: Mapping[str, Any]) -> CalibrationBoard:
    """The inverse of ``board_to_record``."""
    columns, rows = record["inner_corners"]
    charuco = None
    if record["charuco_dictionary"] is not None:
        charuco = Charuco(record["charuco_dictionary"], record["charuco_marker_mm"] * MM)
    return CalibrationBoard(columns, rows, record["square_mm"] * MM, charuco)
