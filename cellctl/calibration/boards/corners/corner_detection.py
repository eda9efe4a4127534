"""Sub-pixel corners of a board of any kind in one image."""

import cv2
import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard, Charuco, Corners, Ids
from cellctl.calibration.boards.corners.board_search import find_chessboard, why_no_chessboard
from cellctl.calibration.boards.corners.circle_centres import measured_rims
from cellctl.calibration.boards.corners.circle_search import find_circles
from cellctl.calibration.boards.corners.corner_saddle import saddle_points
from cellctl.errors.calibration import BoardMirrored, WrongBoard
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_WINDOW_OF_SQUARE = 0.12
_MIN_WINDOW_PX, _MAX_WINDOW_PX = 5, 15
"""Half window of the corner refinement over the side of a square, and its limits: long enough for
many edge pixels, short enough to keep off the next corner and lens distortion. Measured on 140 px
squares: 0.024 px with 5, 0.012 with 15."""
_WINDOW_OF_GAP, _MIN_SADDLE_PX, _MAX_SADDLE_PX = 0.5, 2, 6
"""Half window beside a marker over the gap between corner and marker, and its limits."""
_FEWEST_FOR_STRAYS, _STRAY_ROUNDS = 24, 3
"""With fewer corners the smooth board that they are compared with would follow a stray one."""
_STRAY_PX, _STRAY_MEDIANS = 0.3, 6.0
"""Corners farther than this from a smooth board are no corners of it: in px, and over the median
of the image."""
_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-4)
_MIN_CHARUCO = 12
"""Least number of corners of a view of a ChArUco board."""


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
    half = round(_WINDOW_OF_SQUARE * _square_px(rough, board))
    half = int(np.clip(half, _MIN_WINDOW_PX, _MAX_WINDOW_PX))
    return Corners(rough.ids, _refine(image, found, half))


def why_no_corners(image: Image, board: CalibrationBoard) -> str:
    """Why ``detect_corners`` gives none, for people."""
    if board.charuco is not None:
        return f"fewer than {_MIN_CHARUCO} corners between markers that could be read"
    if board.circles is not None:
        return "no grid of so many circles that is seen whole and ends there"
    return why_no_chessboard(image, board)


def _refine(image: Image, pixels: Array, half: int) -> Array:
    """Refined by the gradients in a window that reaches ``half`` px to each side."""
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
    corners = _charuco_corners(image, pattern, board, charuco)
    # Markers cannot be read in a mirror, so an image without any is tried the other way round.
    if corners is None:
        mirrored = np.ascontiguousarray(image[:, ::-1])
        if _charuco_corners(mirrored, pattern, board, charuco) is not None:
            raise BoardMirrored(f"the {board} is seen as in a mirror")
    return corners


def _charuco_corners(
    image: Image, pattern: cv2.aruco.CharucoBoard, board: CalibrationBoard, charuco: Charuco
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
    rough = Corners(best[1][order], best[0][order])
    return _without_strays(_clear_of_markers(image, rough, board, charuco), board)


def _clear_of_markers(
    image: Image, rough: Corners, board: CalibrationBoard, charuco: Charuco
) -> Corners:
    """Corners refined in windows that no marker reaches into, without those that are none.

    Refined by gradients as a chessboard's are, corners of squares of 20 to 27 px are off by 0.2
    to 3 px, because the edges of the markers are in their windows; as saddle points by 0.05.
    """
    gap = 0.5 * (1.0 - charuco.marker_m / board.square_m)
    half = round(_WINDOW_OF_GAP * gap * _square_px(rough, board))
    half = int(np.clip(half, _MIN_SADDLE_PX, _MAX_SADDLE_PX))
    refined = saddle_points(image, rough.pixels, half)
    found = np.isfinite(refined[:, 0])
    return Corners(rough.ids[found], refined[found])


def _without_strays(corners: Corners, board: CalibrationBoard) -> Corners:
    """Corners without those that do not lie where the others of the image want them."""
    if len(corners.ids) < _FEWEST_FOR_STRAYS:
        return corners
    x, y = (board.corners_m[corners.ids, :2] / np.ptp(board.corners_m[:, :2], axis=0).max()).T
    plane, _ = cv2.findHomography(np.column_stack([x, y]), corners.pixels, cv2.RANSAC, 3.0)
    if plane is None:
        return corners
    seen = np.column_stack([x, y, np.ones_like(x)]) @ plane.T
    off_px = corners.pixels - seen[:, :2] / seen[:, 2:]
    # What perspective does not explain is smooth over the board: lens and bow.
    terms = np.column_stack([x**i * y**j for i in range(4) for j in range(4 - i)])
    kept = np.ones(len(x), dtype=bool)
    for _ in range(_STRAY_ROUNDS):
        smooth, *_ = np.linalg.lstsq(terms[kept], off_px[kept], rcond=None)
        left_px = np.linalg.norm(off_px - terms @ smooth, axis=1)
        limit_px = max(_STRAY_PX, _STRAY_MEDIANS * float(np.median(left_px[kept])))
        kept = left_px < limit_px
    return Corners(corners.ids[kept], corners.pixels[kept])


def _thorough() -> cv2.aruco.DetectorParameters:
    """Parameters for boards that are far, tilted or out of focus: slower, and with markers of all
    sizes."""
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
