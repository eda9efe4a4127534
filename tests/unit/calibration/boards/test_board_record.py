"""A board as plain data of a record, also when somebody has changed it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.calibration.boards.board import CalibrationBoard, Charuco, Circles
from cellctl.calibration.boards.board_record import (
    board_from_record,
    board_to_record,
    corners_from_record,
    corners_to_record,
)

CHESSBOARD = CalibrationBoard(11, 8, 1.5e-3)
CHARUCO = CalibrationBoard(9, 6, 0.025, Charuco("5X5_100", 0.018))
CIRCLES = CalibrationBoard(4, 11, 0.012, circles=Circles(0.009, asymmetric=True))
SIDES = st.integers(3, 30)
VALUES = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3)
KEYS = sorted(board_to_record(CHARUCO))


@given(columns=SIDES, rows=SIDES, square_mm=st.floats(0.5, 100.0))
def test_every_board_comes_back(columns: int, rows: int, square_mm: float) -> None:
    board = CalibrationBoard(columns, rows, square_mm * 1e-3)
    again = board_from_record(board_to_record(board))
    assert (again.columns, again.rows, again.charuco) == (columns, rows, None)
    assert again.square_m == pytest.approx(board.square_m)


@given(st.lists(st.tuples(*[st.floats(-3.0, 3.0)] * 3), min_size=1, max_size=5))
def test_corners_are_the_same_record_however_often_they_are_read_and_written(
    corners: list[tuple[float, float, float]],
) -> None:
    board_m = np.array(corners)
    record = corners_to_record(board_m)
    again_m = corners_from_record(record)
    assert corners_to_record(again_m) == record
    np.testing.assert_allclose(again_m, board_m, atol=0.51e-9)


def test_markers_come_back() -> None:
    again = board_from_record(board_to_record(CHARUCO))
    assert again.charuco is not None
    assert again.charuco.dictionary == "5X5_100"
    assert again.charuco.marker_m == pytest.approx(0.018)


def test_circles_come_back() -> None:
    again = board_from_record(board_to_record(CIRCLES))
    assert again.circles is not None
    assert again.circles.asymmetric
    assert again.circles.diameter_m == pytest.approx(0.009)


def test_a_record_of_an_older_version_has_no_circles() -> None:
    record = board_to_record(CHARUCO)
    del record["circle_mm"], record["circles_asymmetric"]
    assert board_from_record(record).circles is None


@pytest.mark.parametrize(
    "change", [{"circle_mm": 25.0}, {"circle_mm": "9"}, {"circles_asymmetric": 1}]
)
def test_what_are_no_circles_is_refused(change: dict[str, object]) -> None:
    with pytest.raises((TypeError, ValueError)):
        board_from_record({**board_to_record(CIRCLES), **change})


@pytest.mark.parametrize(
    "change",
    [
        {"inner_corners": [11.0, 8]},
        {"inner_corners": [float("nan"), 8]},
        {"inner_corners": [2, 8]},
        {"square_mm": float("inf")},
        {"square_mm": float("nan")},
        {"square_mm": 10**400},
        {"charuco_marker_mm": "18"},
    ],
)
def test_what_is_no_board_is_refused(change: dict[str, object]) -> None:
    with pytest.raises((TypeError, ValueError)):
        board_from_record({**board_to_record(CHARUCO), **change})


@given(
    whole=st.sampled_from([CHARUCO, CIRCLES]),
    key=st.sampled_from(KEYS),
    broken=VALUES | st.lists(VALUES, max_size=3),
)
def test_a_damaged_record_gives_a_board_or_one_of_the_errors_of_records(
    whole: CalibrationBoard, key: str, broken: object
) -> None:
    """What a stored kind turns into ``CalibrationRecordInvalid``."""
    try:
        board = board_from_record({**board_to_record(whole), key: broken})
    except (KeyError, TypeError, ValueError):
        return
    assert min(board.columns, board.rows) >= 3
    assert 0 < board.square_m < 10
