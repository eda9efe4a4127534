"""Grids of circles: found, put into order, and measured to a hundredth of a pixel."""

import functools
import itertools

import numpy as np
import pytest

from cellctl.calibration.boards.board import CalibrationBoard, Circles, Corners, Ids
from cellctl.calibration.boards.board_images import BoardImages, detect_views
from cellctl.calibration.boards.board_shape import BoardShape, shape_modes
from cellctl.calibration.boards.corners.circle_centres import centre_offsets
from cellctl.calibration.boards.corners.corner_detection import detect_corners
from cellctl.errors.calibration import BoardMirrored, WrongBoard
from cellctl.geometry.pose import Array
from fakes.world.scene import LensTruth
from tests.rigs.calibration.circle_boards import (
    GRID,
    STAGGERED,
    SeenGrid,
    dark_circles,
    head,
    seen_grid,
)
from tests.rigs.sweeps import sweep
from tests.unit.calibration.boards.test_board_images import BOARD, draw, view

SQUARE_GRID = CalibrationBoard(7, 7, 0.02, circles=Circles(0.013))
EVEN = CalibrationBoard(4, 10, 0.012, circles=Circles(0.0105, asymmetric=True))
HEAD = head()
TILTS = ((0.0, 0.0, 20.0), (35.0, 10.0, -100.0), (-20.0, 40.0, 170.0))


def numbers(lens: LensTruth) -> Array:
    return np.array([*lens.focal_px, *lens.centre_px, *lens.distortion])


def offsets(board: CalibrationBoard, seen: SeenGrid) -> Array:
    assert board.circles is not None
    pose = seen.camera_T_board
    return centre_offsets(
        numbers(HEAD.left),
        pose.rotation.as_matrix(),
        pose.translation,
        board.corners_m,
        board.circles.diameter_m / 2,
    )


@functools.cache
def seen_once(board: CalibrationBoard, tilt_deg: tuple[float, float, float]) -> SeenGrid:
    """Rendered once for all tests that look at it, which takes longer than finding the grid."""
    return seen_grid(HEAD, board, tilt_deg, np.random.default_rng(3))


def errors_px(board: CalibrationBoard, corners: Corners, truth_px: Array) -> tuple[Array, Ids]:
    """Off by how much, and the corners in the order of the truth: a board may look turned."""
    orders = [board.turned_ids(quarters) for quarters in board.quarter_turns]
    best = min(orders, key=lambda ids: float(np.abs(corners.pixels - truth_px[ids]).max()))
    return corners.pixels - truth_px[best], best


QUICK = ((STAGGERED, TILTS[0], True), (STAGGERED, TILTS[1], False), (GRID, TILTS[1], False),
         (SQUARE_GRID, TILTS[2], False))  # fmt: skip
"""Each grid once, and dark circles once. All others are figures."""


@pytest.mark.parametrize(
    ("board", "tilt_deg", "dark"),
    sweep(itertools.product((STAGGERED, GRID, SQUARE_GRID), TILTS, (False, True)), QUICK),
)
def test_centres_at_oblique_views(
    board: CalibrationBoard, tilt_deg: tuple[float, float, float], dark: bool
) -> None:
    seen = seen_once(board, tilt_deg)
    image = dark_circles(seen.image) if dark else seen.image
    corners = detect_corners(image, board)
    assert corners is not None
    off_px, order = errors_px(board, corners, seen.centres_px)
    bias_px = offsets(board, seen)[order]
    corrected = off_px - bias_px
    assert np.sqrt((corrected**2).mean()) < 0.012
    assert np.abs(corrected).max() < 0.05
    # The centre of the ellipse itself is no measurement of the centre of the circle.
    assert np.sqrt((off_px**2).mean()) > 1.8 * np.sqrt((corrected**2).mean())
    if max(np.abs(tilt_deg[:2])) > 30:
        assert np.sqrt((off_px**2).mean()) > 0.035


def test_a_mirrored_image_is_named_where_the_grid_has_no_mirror_image() -> None:
    image = seen_once(EVEN, TILTS[1]).image
    assert detect_corners(image, EVEN) is not None
    mirrored = np.ascontiguousarray(image[:, ::-1])
    with pytest.raises(BoardMirrored, match=r"670.*4 x 10 asymmetric circle grid"):
        detect_corners(mirrored, EVEN)


@pytest.mark.parametrize(
    "smaller",
    [
        CalibrationBoard(4, 9, 0.012, circles=Circles(0.0105, asymmetric=True)),
        CalibrationBoard(3, 11, 0.012, circles=Circles(0.0105, asymmetric=True)),
    ],
    ids=str,
)
def test_a_part_of_a_larger_grid_is_not_taken(smaller: CalibrationBoard) -> None:
    image = seen_once(STAGGERED, TILTS[0]).image
    assert detect_corners(image, smaller) is None


def test_a_covered_circle_is_no_grid() -> None:
    seen = seen_once(GRID, TILTS[0])
    image = seen.image.copy()
    x, y = np.rint(seen.centres_px[30]).astype(int)
    image[y - 30 : y + 30, x - 30 : x + 30] = image[y - 29, x - 29]
    assert detect_corners(image, GRID) is None


@pytest.mark.figures  # beside the wrong board
def test_a_chessboard_in_place_of_circles_is_named() -> None:
    image = draw(BOARD, view(0))
    with pytest.raises(WrongBoard, match="shows a chessboard, not the 9 x 7 circle grid"):
        detect_views([BoardImages("p0", image, image)], GRID)


def test_which_turns_a_board_hides() -> None:
    assert STAGGERED.quarter_turns == (0,)
    assert GRID.quarter_turns == (0, 2)
    assert SQUARE_GRID.quarter_turns == (0, 1, 2, 3)
    assert EVEN.quarter_turns == (0, 2)
    assert BOARD.quarter_turns == (0,)
    assert CalibrationBoard(9, 7, 0.02).quarter_turns == (0, 2)
    # Opposite corners have one colour, neighbours the other one.
    assert CalibrationBoard(8, 8, 0.02).quarter_turns == (0, 2)
    assert CalibrationBoard(9, 9, 0.02).quarter_turns == (0, 1, 2, 3)


@pytest.mark.parametrize("shape", [BoardShape.BENT, BoardShape.FREE, BoardShape.PRINTED])
@pytest.mark.parametrize("board", [GRID, SQUARE_GRID], ids=str)
def test_only_deviations_that_come_back_after_a_turn_are_released(
    board: CalibrationBoard, shape: BoardShape
) -> None:
    modes = shape_modes(board, shape).modes
    everything = shape_modes(CalibrationBoard(board.columns, board.rows, 0.02), BoardShape.RIGID)
    assert everything.modes.shape[2] == 0
    assert modes.shape[2] == np.linalg.matrix_rank(modes.reshape(-1, modes.shape[2]))
    for quarters in board.quarter_turns[1:]:
        turn = np.eye(3)
        turn[:2, :2] = np.linalg.matrix_power(np.array([[0.0, 1.0], [-1.0, 0.0]]), quarters)
        turned = np.zeros_like(modes)
        turned[board.turned_ids(quarters)] = np.einsum("nkm,kl->nlm", modes, turn)
        np.testing.assert_allclose(turned, modes, atol=1e-12)
    heights = np.abs(modes[:, 2]).max(axis=0)
    # Degrees 2 and 4 without those that change their sign.
    assert (heights > 0.1).sum() == (8 if board is GRID else 4)


@pytest.mark.parametrize(
    ("diameter_m", "asymmetric"), [(0.02, False), (0.0283, True), (0.0, False)]
)
def test_circles_that_touch_are_no_board(diameter_m: float, asymmetric: bool) -> None:
    with pytest.raises(ValueError, match="smaller than their distance"):
        CalibrationBoard(9, 7, 0.02, circles=Circles(diameter_m, asymmetric))
