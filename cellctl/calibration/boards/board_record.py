"""A calibration board as plain data of a record."""

from collections.abc import Mapping
from operator import index
from typing import Any

import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard, Charuco, Circles
from cellctl.geometry.pose import MM, Array

_WIDEST_MM = 10_000
"""No board has squares of ten metres: a length that large is in another unit."""
_DIGITS_OF_A_NANOMETRE = 6
"""Digits behind the point of a length in mm."""


def board_to_record(board: CalibrationBoard) -> dict[str, Any]:
    """Plain data."""
    charuco, circles = board.charuco, board.circles
    return {
        "inner_corners": [board.columns, board.rows],
        "square_mm": board.square_m / MM,
        "charuco_dictionary": None if charuco is None else charuco.dictionary,
        "charuco_marker_mm": None if charuco is None else charuco.marker_m / MM,
        "circle_mm": None if circles is None else circles.diameter_m / MM,
        "circles_asymmetric": circles is not None and circles.asymmetric,
    }


def board_from_record(record: Mapping[str, Any]) -> CalibrationBoard:
    """The inverse of ``board_to_record``.

    Raises ``KeyError``, ``TypeError`` or ``ValueError`` for data that are no board.
    """
    columns, rows = (index(count) for count in record["inner_corners"])
    charuco = None
    if record["charuco_dictionary"] is not None:
        charuco = Charuco(str(record["charuco_dictionary"]), _side_m(record["charuco_marker_mm"]))
    circles = None
    # Records of older versions have no circles.
    if record.get("circle_mm") is not None:
        asymmetric = record["circles_asymmetric"]
        if not isinstance(asymmetric, bool):
            raise TypeError("circles_asymmetric is true or false")
        circles = Circles(_side_m(record["circle_mm"]), asymmetric)
    return CalibrationBoard(columns, rows, _side_m(record["square_mm"]), charuco, circles)


def corners_to_record(board_m: Array) -> dict[str, Any]:
    """Plain data of a board as it was found: its corners, shape (n, 3), in metres.

    Rounded to nanometres, so that a record which is read and written again is the same to the
    last digit: the way from metres to millimetres and back is not.
    """
    corners_mm = np.round(board_m / MM, _DIGITS_OF_A_NANOMETRE)
    height_mm = float(np.round(np.ptp(corners_mm[:, 2]), _DIGITS_OF_A_NANOMETRE))
    return {"board_flatness_mm": height_mm, "board_corners_mm": corners_mm.tolist()}


def corners_from_record(record: Mapping[str, Any]) -> Array:
    """The corners in metres, shape (n, 3): the inverse of ``corners_to_record``."""
    return np.asarray(record["board_corners_mm"], dtype=float) * MM


def _side_m(side_mm: Any) -> float:
    # Compared before it is converted: an integer of JSON may be too large for a float.
    if not 0 < side_mm < _WIDEST_MM:
        raise ValueError(f"{side_mm!r} mm is no side of a square")
    return float(side_mm) * MM
