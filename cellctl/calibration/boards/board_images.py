"""Corners of a calibration board in images, and the faults of images that show none."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from cellctl.calibration.boards.board import (
    BoardView,
    CalibrationBoard,
    CameraView,
    Corners,
)
from cellctl.calibration.boards.corners.board_search import name_chessboard
from cellctl.calibration.boards.corners.corner_detection import detect_corners, why_no_corners
from cellctl.errors.calibration import BoardNotFound, MixedImageSizes, TooFewViews, WrongBoard
from cellctl.errors.vision import ImageBlack, ImageSaturated
from cellctl.interfaces.stereo_camera import Image

_SUSPICIOUS = (1, 4)
"""Numbers of pairs without the board after which, as long as they are the majority, the images are
examined for another board."""
_BLACK_LEVEL = 16
"""An image with hardly a pixel above this is black."""
_FULL_LEVEL = 254
_FULL_ALWAYS, _FULL_SUSPECT = 0.7, 0.2
"""Largest share of saturated pixels in an image that shows the board, and in one in which it was
not found; see ``_check_exposure``."""

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
    """Pairs in which at least one camera does not see the board, with camera and reason."""
    image_size: tuple[int, int]


@dataclass(frozen=True, slots=True)
class DetectedCameraViews:
    """Views of one calibration of a single camera."""

    views: tuple[CameraView, ...]
    not_found: tuple[str, ...]
    """Images without the board, with the reason."""
    image_size: tuple[int, int]


def detect_views(pairs: Sequence[BoardImages], board: CalibrationBoard) -> DetectedViews:
    """Find the board in all pairs.

    Raises ``MixedImageSizes``, ``ImageBlack``, ``ImageSaturated``, ``WrongBoard``,
    ``BoardMirrored``, ``BoardNotFound`` or ``TooFewViews``.
    """
    if not pairs:
        raise TooFewViews("no image pairs were given")
    image_size = _common_size(
        (f"{pair.name} {side}", image)
        for pair in pairs
        for side, image in (("left", pair.left), ("right", pair.right))
    )
    views, missing = _search_all(pairs, board, _look_at_pair, lambda pair: (pair.name, pair.left))
    if not views:
        raise BoardNotFound(f"no pair shows the {board}; {missing[0]}")
    return DetectedViews(tuple(views), tuple(missing), image_size)


def detect_camera_views(
    images: Sequence[BoardImage], board: CalibrationBoard
) -> DetectedCameraViews:
    """Find the board in all images; raises as ``detect_views`` does."""
    if not images:
        raise TooFewViews("no images were given")
    image_size = _common_size((one.name, one.image) for one in images)
    views, missing = _search_all(images, board, _look_at_image, lambda o: (o.name, o.image))
    if not views:
        raise BoardNotFound(f"no image shows the {board}; {missing[0]}")
    return DetectedCameraViews(tuple(views), tuple(missing), image_size)


def detect_view(pair: BoardImages, board: CalibrationBoard) -> BoardView | None:
    """The board in one pair, or None.

    Raises ``ImageBlack``, ``ImageSaturated`` or ``BoardMirrored``.
    """
    seen = _look_at_pair(pair, board)
    return None if isinstance(seen, _NotSeen) else seen


def detect_camera_view(one: BoardImage, board: CalibrationBoard) -> CameraView | None:
    """The board in one image, or None; raises as ``detect_view`` does."""
    seen = _look_at_image(one, board)
    return None if isinstance(seen, _NotSeen) else seen


@dataclass(frozen=True, slots=True)
class _NotSeen:
    why: str


def _look_at_pair(pair: BoardImages, board: CalibrationBoard) -> BoardView | _NotSeen:
    left = _look(pair.left, f"{pair.name} left", board)
    right = _look(pair.right, f"{pair.name} right", board)
    if isinstance(left, Corners) and isinstance(right, Corners):
        return BoardView(pair.name, left, right)
    reasons = [
        f"{side} image: {seen.why}"
        for side, seen in (("left", left), ("right", right))
        if isinstance(seen, _NotSeen)
    ]
    return _NotSeen(", ".join(reasons))


def _look_at_image(one: BoardImage, board: CalibrationBoard) -> CameraView | _NotSeen:
    seen = _look(one.image, one.name, board)
    return CameraView(one.name, seen) if isinstance(seen, Corners) else seen


def _look(image: Image, name: str, board: CalibrationBoard) -> Corners | _NotSeen:
    corners = detect_corners(image, board)
    _check_exposure(name, image, board_found=corners is not None)
    return _NotSeen(why_no_corners(image, board)) if corners is None else corners


def _search_all(
    exposures: Sequence[T],
    board: CalibrationBoard,
    look: Callable[[T, CalibrationBoard], V | _NotSeen],
    shown: Callable[[T], tuple[str, Image]],
) -> tuple[list[V], list[str]]:
    """Views, and names with reasons of the exposures without one.

    ``shown`` gives the name and an image of an exposure.
    """
    views: list[V] = []
    missing: list[str] = []
    for exposure in exposures:
        view = look(exposure, board)
        if not isinstance(view, _NotSeen):
            views.append(view)
            continue
        name, image = shown(exposure)
        missing.append(f"{name} ({view.why})")
        # Trying all sizes of board takes long, so only twice, and only while most fail.
        if len(missing) in _SUSPICIOUS and len(views) < len(missing):
            _check_board(name, image, board)
    return views, missing


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
    if board.circles is not None:
        raise WrongBoard(f"{name} shows a chessboard, not the {board}")
    if {columns, rows} != {board.columns, board.rows}:
        raise WrongBoard(f"{name} shows {columns} x {rows} inner corners, not the {board}")
