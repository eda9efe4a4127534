"""Corners of a calibration board in images, and the faults of images that show none."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np

from cellctl.calibration.boards.board import (
    BoardView,
    CalibrationBoard,
    CameraView,
    Charuco,
    Corners,
)
from cellctl.calibration.boards.board_search import find_chessboard, name_chessboard
from cellctl.errors.calibration import BoardNotFound, MixedImageSizes, TooFewViews, WrongBoard
from cellctl.errors.vision import ImageBlack, ImageSaturated
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_WINDOW_OF_SQUARE = 0.12
_MIN_WINDOW_PX, _MAX_WINDOW_PX = 5, 15
"""Half window of the corner refinement: long enough for many edge pixels, short enough to keep off
the next corner and lens distortion. Measured on 140 px squares: 0.024 px with 5, 0.012 with 15."""
_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-4)
_MIN_CHARUCO = 12
_SUSPICIOUS = (1, 4)
"""After so many pairs without the board, when they are the majority, see whether it is another."""
_BLACK_LEVEL = 16
_FULL_LEVEL = 254
_FULL_ALWAYS, _FULL_SUSPECT = 0.7, 0.2

T = TypeVar("T")
V = TypeVar("V")


@dataclass(frozen=True, slots=True, eq=False)
class BoardImages:
    """Two images of one exposure and the name they are reported by."""

    name: str
    left: Image
    right: Image


@dataclass(frozen=True, slots=True, eq=False)
class BoardImage:
    """The image of a single camera and the name it is reported by."""

    name: str
    image: Image


@dataclass(frozen=True, slots=True)
class DetectedViews:
    """Views of one calibration of a stereo head."""

    views: tuple[BoardView, ...]
    not_found: tuple[str, ...]
    """Pairs in which at least one camera does not see the board."""
    image_size: tuple[int, int]


@dataclass(frozen=True, slots=True)
class DetectedCameraViews:
    """Views of one calibration of a single camera."""

    views: tuple[CameraView, ...]
    not_found: tuple[str, ...]
    """Images without the board."""
    image_size: tuple[int, int]


def detect_views(pairs: Sequence[BoardImages], board: CalibrationBoard) -> DetectedViews:
    """Find the board in all pairs.

    Raises ``MixedImageSizes``, ``ImageBlack``, ``ImageSaturated``, ``WrongBoard``,
    ``BoardNotFound`` or ``TooFewViews``.
    """
    if not pairs:
        raise TooFewViews("no image pairs were given")
    image_size = _common_size(
        (f"{pair.name} {side}", image)
        for pair in pairs
        for side, image in (("left", pair.left), ("right", pair.right))
    )
    views, missing = _search_all(pairs, board, detect_view, lambda pair: (pair.name, pair.left))
    if not views:
        raise BoardNotFound(f"no pair shows the {board}")
    return DetectedViews(tuple(views), tuple(missing), image_size)


def detect_camera_views(
    images: Sequence[BoardImage], board: CalibrationBoard
) -> DetectedCameraViews:
    """Find the board in all images; raises as ``detect_views`` does."""
    if not images:
        raise TooFewViews("no images were given")
    image_size = _common_size((one.name, one.image) for one in images)
    views, missing = _search_all(images, board, detect_camera_view, lambda o: (o.name, o.image))
    if not views:
        raise BoardNotFound(f"no image shows the {board}")
    return DetectedCameraViews(tuple(views), tuple(missing), image_size)


def detect_view(pair: BoardImages, board: CalibrationBoard) -> BoardView | None:
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


def detect_camera_view(one: BoardImage, board: CalibrationBoard) -> CameraView | None:
    """The board in one image, or None; raises ``ImageBlack`` or ``ImageSaturated``."""
    found = detect_corners(one.image, board)
    _check_exposure(one.name, one.image, board_found=found is not None)
    return None if found is None else CameraView(one.name, found)


def _search_all(
    exposures: Sequence[T],
    board: CalibrationBoard,
    detect: Callable[[T, CalibrationBoard], V | None],
    shown: Callable[[T], tuple[str, Image]],
) -> tuple[list[V], list[str]]:
    """Views, and the names of the exposures without one; ``shown`` gives name and an image."""
    views: list[V] = []
    missing: list[str] = []
    for exposure in exposures:
        view = detect(exposure, board)
        if view is not None:
            views.append(view)
            continue
        name, image = shown(exposure)
        missing.append(name)
        # Trying all sizes of board takes long, so only twice, and only while most fail.
        if len(missing) in _SUSPICIOUS and len(views) < len(missing):
            _check_board(name, image, board)
    return views, missing


def detect_corners(image: Image, board: CalibrationBoard) -> Corners | None:
    """Corners of the board in one image, or None."""
    if board.charuco is not None:
        return _detect_charuco(image, board, board.charuco)
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


def _common_size(images: Iterable[tuple[str, Image]]) -> tuple[int, int]:
    sizes: dict[tuple[int, int], str] = {}
    for name, image in images:
        sizes.setdefault((image.shape[1], image.shape[0]), name)
    if len(sizes) > 1:
        raise MixedImageSizes("; ".join(f"{w} x {h} ({n})" for (w, h), n in sizes.items()))
    return next(iter(sizes))


def _check_exposure(name: str, image: Image, *, board_found: bool) -> None:
    # A quantile, because some hot pixels do not light a black image.
    if float(np.percentile(image, 99.9)) < _BLACK_LEVEL:
        raise ImageBlack(f"{name}: 99.9 % of the pixels are below level {_BLACK_LEVEL}")
    full = float((image >= _FULL_LEVEL).mean())
    # White squares may be at full scale without harm to the corners. Where no board was found,
    # saturation is likely to be the reason.
    if full > (_FULL_ALWAYS if board_found else _FULL_SUSPECT):
        raise ImageSaturated(f"{name}: {full:.0%} of the pixels are at full scale")


def _check_board(name: str, image: Image, board: CalibrationBoard) -> None:
    """Raise ``WrongBoard`` if there is another chessboard in an image without the board."""
    seen = name_chessboard(image)
    if seen is None:
        return
    columns, rows = seen
    # Markers would have been found: this board has none.
    if board.charuco is not None:
        raise WrongBoard(f"{name} shows a chessboard without a marker of the {board}")
    if {columns, rows} != {board.columns, board.rows}:
        raise WrongBoard(f"{name} shows {columns} x {rows} inner corners, not the {board}")
