"""Corners of a calibration board in images, and the wrong images that give none."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.calibration.board import BoardView, CalibrationBoard, Charuco, Corners
from cellctl.errors.calibration import BoardNotFound, MixedImageSizes, TooFewViews, WrongBoard
from cellctl.errors.vision import ImageBlack, ImageSaturated
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_SEARCH_PX = (1000, 500)
"""Longer side of the reduced images in which a chessboard is searched."""
_MAX_CORNERS = 16
_WINDOW_OF_SQUARE = 0.12
_MIN_WINDOW_PX, _MAX_WINDOW_PX = 5, 15
"""Half window of the corner refinement: long enough for many edge pixels, short enough to keep off
the next corner and lens distortion. Measured on 140 px squares: 0.024 px with 5, 0.012 with 15."""
_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-4)
_MIN_CHARUCO = 12
_BLACK_LEVEL = 16
_FULL_LEVEL = 254
_FULL_ALWAYS, _FULL_SUSPECT = 0.7, 0.2


@dataclass(frozen=True, slots=True)
class ImagePair:
    """Two images of one exposure and the name they are reported by."""

    name: str
    left: Image
    right: Image


@dataclass(frozen=True, slots=True)
class DetectedViews:
    """Views of one calibration."""

    views: tuple[BoardView, ...]
    not_found: tuple[str, ...]
    """Pairs in which at least one camera does not see the board."""
    image_size: tuple[int, int]


def detect_views(pairs: Sequence[ImagePair], board: CalibrationBoard) -> DetectedViews:
    """Find the board in all pairs.

    Raises ``MixedImageSizes``, ``ImageBlack``, ``ImageSaturated``, ``WrongBoard``,
    ``BoardNotFound`` or ``TooFewViews``.
    """
    if not pairs:
        raise TooFewViews("no image pairs were given")
    image_size = _common_size(pairs)
    views, missing = [], []
    for pair in pairs:
        view = detect_view(pair, board)
        if view is None:
            missing.append(pair.name)
        else:
            views.append(view)
    if not views:
        _raise_not_found(pairs[0], board)
    return DetectedViews(tuple(views), tuple(missing), image_size)


def detect_view(pair: ImagePair, board: CalibrationBoard) -> BoardView | None:
    """The board in one pair, or None; raises ``ImageBlack`` or ``ImageSaturated``."""
    corners = []
    for side, image in (("left", pair.left), ("right", pair.right)):
        found = detect_corners(image, board)
        _check_exposure(f"{pair.name} {side}", image, board_found=found is not None)
        corners.append(found)
    left, right = corners
    if left is None or right is None:
        return None
    return BoardView(pair.name, left, right)


def detect_corners(image: Image, board: CalibrationBoard) -> Corners | None:
    """Corners of the board in one image, or None."""
    if board.charuco is not None:
        return _detect_charuco(image, board, board.charuco)
    found = _search(image, (board.columns, board.rows))
    if found is None:
        return None
    found = _right_handed(found, board)
    rough = Corners(np.arange(len(found)), found)
    pixels = _refine(image, found, _square_px(rough, board))
    if not _first_cell_is_dark(image, pixels, board) and not board.symmetric:
        pixels = pixels[::-1]
    return Corners(np.arange(len(pixels)), np.ascontiguousarray(pixels))


def _search(image: Image, size: tuple[int, int]) -> Array | None:
    """Corners to a pixel or so, in any of the orders that fit the size.

    The quadrangle search is quick and needs no wide white margin; the sector search sees more
    under strong tilt or blur, and needs its exhaustive mode where the surroundings are dark.
    """
    for longest_px in _SEARCH_PX:
        small = _reduced(image, longest_px)
        flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
        is_found, corners = cv2.findChessboardCorners(
            small, size, flags=flags | cv2.CALIB_CB_FAST_CHECK
        )
        if not is_found:
            flags = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_NORMALIZE_IMAGE
            is_found, corners = cv2.findChessboardCornersSB(small, size, flags=flags)
        if is_found:
            ratio = np.array([image.shape[1] / small.shape[1], image.shape[0] / small.shape[0]])
            return np.asarray((corners.reshape(-1, 2) + 0.5) * ratio - 0.5, dtype=float)
    return None


def _reduced(image: Image, longest_px: int) -> Image:
    scale = max(image.shape) / longest_px
    if scale <= 1:
        return image
    shape = (round(image.shape[1] / scale), round(image.shape[0] / scale))
    return np.asarray(cv2.resize(image, shape, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _right_handed(pixels: Array, board: CalibrationBoard) -> Array:
    """Mirror the rows if need be, so that rows and columns turn like x and y of the image."""
    grid = pixels.reshape(board.rows, board.columns, 2)
    along_row, along_column = grid[-1, -1] - grid[-1, 0], grid[-1, 0] - grid[0, 0]
    area = along_row[0] * along_column[1] - along_row[1] * along_column[0]
    ordered = grid if area > 0 else grid[:, ::-1]
    return np.ascontiguousarray(ordered.reshape(-1, 2))


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


def _first_cell_is_dark(image: Image, pixels: Array, board: CalibrationBoard) -> bool:
    """Whether the square between the first four corners is darker than its neighbours."""
    grid = pixels.reshape(board.rows, board.columns, 2)
    middles = (grid[:-1, :-1] + grid[1:, 1:] + grid[:-1, 1:] + grid[1:, :-1]) / 4
    columns, rows = np.rint(middles).astype(int).transpose(2, 0, 1)
    values = image[
        np.clip(rows, 0, image.shape[0] - 1), np.clip(columns, 0, image.shape[1] - 1)
    ].astype(float)
    parity = np.add.outer(np.arange(values.shape[0]), np.arange(values.shape[1])) % 2
    return bool(values[parity == 0].mean() < values[parity == 1].mean())


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


def _common_size(pairs: Sequence[ImagePair]) -> tuple[int, int]:
    sizes: dict[tuple[int, int], str] = {}
    for pair in pairs:
        for side, image in (("left", pair.left), ("right", pair.right)):
            sizes.setdefault((image.shape[1], image.shape[0]), f"{pair.name} {side}")
    if len(sizes) > 1:
        raise MixedImageSizes("; ".join(f"{w} x {h} ({n})" for (w, h), n in sizes.items()))
    return next(iter(sizes))


def _check_exposure(name: str, image: Image, *, board_found: bool) -> None:
    if float(np.percentile(image, 99.9)) < _BLACK_LEVEL:
        raise ImageBlack(f"{name}: 99.9 % of the pixels are below level {_BLACK_LEVEL}")
    full = float((image >= _FULL_LEVEL).mean())
    if full > (_FULL_ALWAYS if board_found else _FULL_SUSPECT):
        raise ImageSaturated(f"{name}: {full:.0%} of the pixels are at full scale")


def _raise_not_found(pair: ImagePair, board: CalibrationBoard) -> None:
    """Say what is there instead of the board, if that can be told."""
    seen = _other_board(pair.left, board)
    if seen is not None:
        raise WrongBoard(f"{pair.name} shows {seen}, not the {board}")
    raise BoardNotFound(f"no pair shows the {board}; first pair: {pair.name}")


def _other_board(image: Image, board: CalibrationBoard) -> str | None:
    """Another chessboard in the image, by trying sizes; slow, but only for the message."""
    sizes = [(c, r) for c in range(3, _MAX_CORNERS) for r in range(3, c + 1)]
    small = _reduced(image, _SEARCH_PX[-1])
    flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK
    for size in sorted(sizes, key=lambda size: -size[0] * size[1]):
        if cv2.findChessboardCorners(small, size, flags=flags)[0]:
            without = " without markers" if board.charuco is not None else ""
            return f"a chessboard with {size[0]} x {size[1]} inner corners{without}"
    return None
