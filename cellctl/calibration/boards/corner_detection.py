"""Sub-pixel corners of a board of any kind in one image."""

import cv2
import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard, Charuco, Corners
from cellctl.calibration.boards.board_search import find_chessboard
from cellctl.calibration.boards.circle_centres import measured_rims
from cellctl.calibration.boards.circle_search import find_circles
from cellctl.errors.calibration import BoardMirrored, WrongBoard
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_WINDOW_OF_SQUARE = 0.12
_MIN_WINDOW_PX, _MAX_WINDOW_PX = 5, 15
"""Half window of the corner refinement: long enough for many edge pixels, short enough to keep off
the next corner and lens distortion. Measured on 140 px squares: 0.024 px with 5, 0.012 with 15."""
_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-4)
_MIN_CHARUCO = 12


def detect_corners(image: Image, board: CalibrationBoard) -> Corners | None:
    """Corners of the board in one image, or None.

    Of a circle grid these are the centres of the ellipses in the image, which are not where the
    centres of the circles are seen; ``true_centres`` corrects that. Raises ``WrongBoard`` or
    ``BoardMirrored``.
    """
    if board.charuco is not None:
        return _detect_charuco(image, board, board.charuco)
    if board.circles is not None:
        return _detect_circles(image, board)
    found = find_chessboard(image, board)
    if found is None:
        return None
    rough = Corners(np.arange(len(found)), found)
    return Corners(rough.ids, _refine(image, found, _square_px(rough, board)))


def _refine(image: Image, pixels: Array, square_px: float) -> Array:
    half = int(np.clip(round(_WINDOW_OF_SQUARE * square_px), _MIN_WINDOW_PX, _MAX_WINDOW_PX))
    # Smoothing keeps a corner's symmetry, so it costs noise only, not accuracy.
    smooth = cv2.GaussianBlur(image, (0, 0), 1.0) if half > _MIN_WINDOW_PX else image
    start = pixels.astype(np.float32).reshape(-1, 1, 2)
    refined = cv2.cornerSubPix(smooth, start, (half, half), (-1, -1), _CRITERIA)
    return np.asarray(refined, dtype=float).reshape(-1, 2)


def _square_px(corners: Corners, board: CalibrationBoard) -> float:
    """Typical side of a square in the image: the smaller of its median width and height."""
    place = np.full((board.rows * board.columns, 2), np.nan)
    place[corners.ids] = corners.pixels
    grid = place.reshape(board.rows, board.columns, 2)
    sides = [np.linalg.norm(np.diff(grid, axis=axis), axis=2) for axis in (0, 1)]
    return float(min(np.nanmedian(side) for side in sides))


def _detect_charuco(image: Image, board: CalibrationBoard, charuco: Charuco) -> Corners | None:
    dictionary_id = getattr(cv2.aruco, f"DICT_{charuco.dictionary}", None)
    if not isinstance(dictionary_id, int):
        raise WrongBoard(f"there is no marker dictionary {charuco.dictionary!r}")
    size = (board.columns + 1, board.rows + 1)
    dictionary = cv2.aruco.getPredefinedDictionary(dictionary_id)
    pattern = cv2.aruco.CharucoBoard(size, board.square_m, charuco.marker_m, dictionary)
    found, ids, _, _ = cv2.aruco.CharucoDetector(pattern).detectBoard(image)
    if ids is None or len(ids) < _MIN_CHARUCO:
        return None
    order = np.argsort(np.ravel(ids))
    sorted_ids = np.ravel(ids)[order].astype(np.int64)
    pixels = np.asarray(found, dtype=float).reshape(-1, 2)[order]
    # Markers stand close to the corners, so the smallest window.
    return Corners(sorted_ids, _refine(image, pixels, 0.0))


def _detect_circles(image: Image, board: CalibrationBoard) -> Corners | None:
    found = find_circles(image, board)
    if found is None:
        return None
    if found.mirrored:
        raise BoardMirrored(f"the {board} is seen as in a mirror")
    rims = measured_rims(image, found.rims, bright=found.bright)
    return None if rims is None else Corners(np.arange(len(rims.centres)), rims.centres)
