"""Sub-pixel corners of a board of any kind in one image."""

import cv2
import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard, Charuco, Corners, Ids
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
    pattern = cv2.aruco.CharucoBoard(
        (board.columns + 1, board.rows + 1),
        board.square_m,
        charuco.marker_m,
        cv2.aruco.getPredefinedDictionary(dictionary_id),
    )
    corners = _charuco_corners(image, pattern, board)
    # Markers cannot be read in a mirror, so an image without any is tried the other way round.
    if (
        corners is None
        and _charuco_corners(np.ascontiguousarray(image[:, ::-1]), pattern, board) is not None
    ):
        raise BoardMirrored(f"the {board} is seen as in a mirror")
    return corners


def _charuco_corners(
    image: Image, pattern: cv2.aruco.CharucoBoard, board: CalibrationBoard
) -> Corners | None:
    count = board.columns * board.rows
    best: tuple[Array, Ids] | None = None
    for parameters in (cv2.aruco.DetectorParameters(), _thorough()):
        refined = cv2.aruco.CharucoParameters()
        # Markers that were not read are looked for where the others say that they must be.
        refined.tryRefineMarkers = True
        found, ids, _, _ = cv2.aruco.CharucoDetector(pattern, refined, parameters).detectBoard(
            image
        )
        if ids is None or (best is not None and len(ids) <= len(best[1])):
            continue
        best = np.asarray(found, dtype=float).reshape(-1, 2), np.ravel(ids).astype(np.int64)
        if len(ids) == count:
            break
    if best is None or len(best[1]) < _MIN_CHARUCO:
        return None
    order = np.argsort(best[1])
    # Markers stand close to the corners, so the smallest window.
    return Corners(best[1][order], _refine(image, best[0][order], 0.0))


def _thorough() -> cv2.aruco.DetectorParameters:
    """For boards that are far, tilted or out of focus: slower, and with markers of all sizes."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMax = 53
    parameters.minMarkerPerimeterRate = 0.01
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    return parameters


def _detect_circles(image: Image, board: CalibrationBoard) -> Corners | None:
    found = find_circles(image, board)
    if found is None:
        return None
    if found.mirrored:
        raise BoardMirrored(f"the {board} is seen as in a mirror")
    rims = measured_rims(image, found.rims, bright=found.bright)
    return None if rims is None else Corners(np.arange(len(rims.centres)), rims.centres)
