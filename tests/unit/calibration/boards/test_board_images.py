import re
from functools import cache

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.calibration.boards.board import CalibrationBoard, Charuco
from cellctl.calibration.boards.board_images import BoardImages, detect_views
from cellctl.calibration.boards.corners.corner_detection import detect_corners
from cellctl.errors.calibration import BoardNotFound, MixedImageSizes, TooFewViews, WrongBoard
from cellctl.errors.vision import ImageBlack, ImageSaturated

BOARD = CalibrationBoard(9, 6, 0.025)
CHARUCO = CalibrationBoard(9, 6, 0.025, Charuco("5X5_100", 0.018))
SIZE = (1224, 1024)
SQUARE_PX = 60
Array = NDArray[np.float64]
Image = NDArray[np.uint8]


def view(number: int) -> Array:
    """Homography from board pixels (SQUARE_PX a square, first corner at the origin) to image."""
    rng = np.random.default_rng(number)
    turn = np.radians(rng.uniform(-25, 25))
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    matrix = np.eye(3)
    matrix[:2, :2] = rotation @ np.diag(rng.uniform(0.8, 1.1, 2))
    matrix[2, :2] = rng.uniform(-2e-4, 2e-4, 2)
    middle = matrix @ [4 * SQUARE_PX, 2.5 * SQUARE_PX, 1]
    shift = np.eye(3)
    shift[:2, 2] = np.array(SIZE) / 2 - middle[:2] / middle[2] + rng.uniform(-40, 40, 2)
    return shift @ matrix


def draw(board: CalibrationBoard, homography: Array, *, samples: int = 8) -> Image:
    """A chessboard; each pixel is the mean of samples that lie on no common row or column."""
    grey = np.full((SIZE[1], SIZE[0]), 200.0)
    columns, rows = _where(board, homography)
    u, v = np.meshgrid(*(np.arange(one.start, one.stop, dtype=float) for one in (columns, rows)))
    back = np.linalg.inv(homography)
    middles = np.tensordot(back, np.stack([u, v, np.ones_like(u)]), axes=1)
    dark = np.zeros(u.shape)
    for sample in range(samples):
        du, dv = (sample + 0.5) / samples - 0.5, (sample * 0.618034) % 1 - 0.5
        x, y, w = middles + (back @ [du, dv, 0.0])[:, np.newaxis, np.newaxis]
        x, y = x / (w * SQUARE_PX), y / (w * SQUARE_PX)
        inside = (x > -1) & (x < board.columns) & (y > -1) & (y < board.rows)
        dark += inside & ((np.floor(x) + np.floor(y)) % 2 == 0)
    grey[rows, columns] -= 160.0 * dark / samples
    return np.clip(np.rint(cv2.GaussianBlur(grey, (0, 0), 1.0)), 0, 255).astype(np.uint8)


@cache
def drawn(number: int, samples: int) -> Image:
    """The chessboard in a view, for tests that do not write into it."""
    image = draw(BOARD, view(number), samples=samples)
    image.flags.writeable = False
    return image


def _where(board: CalibrationBoard, homography: Array) -> tuple[slice, slice]:
    """Columns and rows of the image that hold the whole board."""
    ends = [(x, y) for x in (-1, board.columns) for y in (-1, board.rows)]
    points = np.column_stack([np.array(ends) * SQUARE_PX, np.ones(4)]) @ homography.T
    pixels = points[:, :2] / points[:, 2:]
    low = np.clip(np.floor(pixels.min(axis=0)) - 1, 0, SIZE).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 2, 0, SIZE).astype(int)
    return slice(low[0], high[0]), slice(low[1], high[1])


def expected(board: CalibrationBoard, homography: Array) -> Array:
    column, row = np.meshgrid(np.arange(board.columns), np.arange(board.rows))
    points = np.stack([column.ravel(), row.ravel(), np.zeros(column.size)], axis=1) * SQUARE_PX
    points[:, 2] = 1
    moved = points @ homography.T
    return np.asarray(moved[:, :2] / moved[:, 2:], dtype=np.float64)


@pytest.mark.parametrize("number", range(3))
def test_corners_are_sub_pixel_and_in_the_board_order(number: int) -> None:
    homography = view(number)
    corners = detect_corners(drawn(number, 32), BOARD)
    assert corners is not None
    np.testing.assert_array_equal(corners.ids, np.arange(54))
    assert np.abs(corners.pixels - expected(BOARD, homography)).max() < 0.05


def test_order_follows_the_colours_when_the_camera_is_upside_down() -> None:
    homography = view(1)
    image = drawn(1, 32)
    corners = detect_corners(np.ascontiguousarray(image[::-1, ::-1]), BOARD)
    assert corners is not None
    upright = np.array(SIZE) - 1 - corners.pixels
    assert np.abs(upright - expected(BOARD, homography)).max() < 0.05


def test_charuco_in_part() -> None:
    assert CHARUCO.charuco is not None
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_100)
    pattern = cv2.aruco.CharucoBoard((10, 7), 0.025, 0.018, dictionary)
    image = np.full((900, 900), 200, np.uint8)
    drawn = cv2.resize(
        pattern.generateImage((2000, 1400)), (1000, 700), interpolation=cv2.INTER_AREA
    )
    image[100:800, 50:] = drawn[:, :850]
    blurred = np.asarray(cv2.GaussianBlur(image, (0, 0), 1.0), dtype=np.uint8)
    corners = detect_corners(blurred, CHARUCO)
    assert corners is not None
    assert 12 <= len(corners.ids) < 54
    row, column = np.divmod(corners.ids, 9)
    truth = np.stack([50 + 100 * (column + 1), 100 + 100 * (row + 1)], axis=1) - 0.5
    assert np.abs(corners.pixels - truth).max() < 0.1


def pairs(count: int = 3) -> list[BoardImages]:
    images = [drawn(number, 4) for number in range(count)]
    return [BoardImages(f"p{n}", image, image) for n, image in enumerate(images)]


def test_pairs_without_the_board_are_named() -> None:
    given = pairs()
    plain = np.full((SIZE[1], SIZE[0]), 120, np.uint8)
    given[1] = BoardImages("p1", given[1].left, plain)
    found = detect_views(given, BOARD)
    assert [one.name for one in found.views] == ["p0", "p2"]
    assert found.not_found == ("p1 (right image: not seen whole and sharp)",)
    assert found.image_size == SIZE


def test_a_board_that_goes_on_is_refused_with_camera_side_and_reason() -> None:
    given = pairs()
    whole = draw(CalibrationBoard(13, 10, 0.025), view(0), samples=4)
    given[1] = BoardImages("p1", given[1].left, whole)
    found = detect_views(given, BOARD)
    assert [one.name for one in found.views] == ["p0", "p2"]
    (refused,) = found.not_found
    assert re.fullmatch(
        r"p1 \(right image: the pattern goes on beyond its right side: .*\)", refused
    )


@pytest.mark.parametrize(
    ("level", "fault"), [(0, ImageBlack), (255, ImageSaturated)], ids=["black", "saturated"]
)
def test_black_and_saturated_images_are_named(level: int, fault: type[Exception]) -> None:
    given = pairs(2)
    given[1] = BoardImages("p1", given[1].left, np.full((SIZE[1], SIZE[0]), level, np.uint8))
    with pytest.raises(fault, match="p1 right"):
        detect_views(given, BOARD)


def test_mixed_sizes() -> None:
    given = pairs(2)
    given[1] = BoardImages("p1", given[1].left[:-8], given[1].right)
    with pytest.raises(MixedImageSizes, match=r"1224 x 1024 \(p0 left\); 1224 x 1016 \(p1 left\)"):
        detect_views(given, BOARD)


def test_wrong_board_says_what_is_there() -> None:
    with pytest.raises(WrongBoard, match=r"p0 shows 9 x 6 inner corners, not the 8 x 6"):
        detect_views(pairs(1), CalibrationBoard(8, 6, 0.025))


@pytest.mark.figures  # beside the wrong board
def test_chessboard_in_place_of_charuco() -> None:
    with pytest.raises(WrongBoard, match="without a marker"):
        detect_views(pairs(1), CHARUCO)


def test_unknown_dictionary() -> None:
    board = CalibrationBoard(9, 6, 0.025, Charuco("9X9_7", 0.018))
    with pytest.raises(WrongBoard, match="9X9_7"):
        detect_views(pairs(1), board)


def test_no_board_at_all() -> None:
    noise = np.random.default_rng(0).integers(80, 120, (400, 500)).astype(np.uint8)
    with pytest.raises(BoardNotFound, match=r"no pair shows the 9 x 6 chessboard.*p0 \(left image"):
        detect_views([BoardImages("p0", noise, noise)], BOARD)
    with pytest.raises(TooFewViews):
        detect_views([], BOARD)


@pytest.mark.parametrize("margin", [0.15, 0.4])
def test_a_whole_board_with_a_narrow_margin_is_taken(margin: float) -> None:
    homography = view(1)
    image = drawn(1, 32).copy()
    ends = np.array([(x, y) for x, y in ((-1, -1), (9, -1), (9, 6), (-1, 6))], dtype=float)
    middle = ends.mean(axis=0)
    ends += np.sign(ends - middle) * margin
    points = np.column_stack([ends * SQUARE_PX, np.ones(4)]) @ homography.T
    outline = np.rint(points[:, :2] / points[:, 2:]).astype(np.int32)
    mask = np.zeros_like(image)
    cv2.fillPoly(mask, [outline], 255)
    # Beyond its edge there is something as dark as the squares.
    image[mask == 0] = 45
    corners = detect_corners(image, BOARD)
    assert corners is not None
    assert np.abs(corners.pixels - expected(BOARD, homography)).max() < 0.1
