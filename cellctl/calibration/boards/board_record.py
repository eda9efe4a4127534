"""A calibration board as plain data of a record."""

from collections.abc import Mapping
from operator import index
from typing import Any

from cellctl.calibration.boards.board import CalibrationBoard, Charuco
from cellctl.geometry.pose import MM

_WIDEST_MM = 10_000


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
    """The inverse of ``board_to_record``.

    Raises ``KeyError``, ``TypeError`` or ``ValueError`` for data that are no board.
    """
    columns, rows = (index(count) for count in record["inner_corners"])
    charuco = None
    if record["charuco_dictionary"] is not None:
        charuco = Charuco(str(record["charuco_dictionary"]), _side_m(record["charuco_marker_mm"]))
    return CalibrationBoard(columns, rows, _side_m(record["square_mm"]), charuco)


def _side_m(side_mm: Any) -> float:
    # Compared before it is converted: an integer of JSON may be too large for a float.
    if not 0 < side_mm < _WIDEST_MM:
        raise ValueError(f"{side_mm!r} mm is no side of a square")
    return float(side_mm) * MM
