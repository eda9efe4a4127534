"""Finds a chessboard in an image, to about a pixel, with its corners in the board's own order."""

import cv2
import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_SEARCH_PX, _THOROUGH_PX = (1000, 500), 600
"""Longer side of the reduced images in which a chessboard is searched."""
_QUICK = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK
_THOROUGH = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_NORMALIZE_IMAGE
_MAX_CORNERS = 16
"""Boards of unknown size are tried with fewer corners than this along each side: every size takes a
search of its own."""
_CONTINUES = 0.6
"""Contrast of a line of corners beyond the last one against that of the last one. Where the board
ends, two of the four squares about such a corner are missing, which leaves half."""


def find_chessboard(image: Image, board: CalibrationBoard) -> Array | None:
    """Corners, shape (rows * columns, 2), or None; a part of a larger board is not taken."""
    found = _search(image, (board.columns, board.rows))
    if found is None:
        return None
    grid = _right_handed(found.reshape(board.rows, board.columns, 2))
    if _side_that_continues(image, grid) is not None:
        return None
    # The colours tell which end is the first, so that an upside-down camera does not pass for a
    # turned board.
    if not board.symmetric and not _first_cell_is_dark(image, grid):
        grid = grid[::-1, ::-1]
    return np.ascontiguousarray(grid.reshape(-1, 2))


def why_no_chessboard(image: Image, board: CalibrationBoard) -> str:
    """Why ``find_chessboard`` gives none, for people."""
    found = _search(image, (board.columns, board.rows))
    if found is None:
        return "not seen whole and sharp"
    grid = _right_handed(found.reshape(board.rows, board.columns, 2))
    side = _side_that_continues(image, grid)
    return f"the pattern goes on beyond its {side} side: it has more corners than were given"


def name_chessboard(image: Image) -> tuple[int, int] | None:
    """Columns and rows of whatever chessboard is in the image. Slow: it tries all sizes."""
    sizes = [(c, r) for c in range(3, _MAX_CORNERS) for r in range(3, c + 1)]
    small = _reduced(image, _SEARCH_PX[-1])
    for columns, rows in sorted(sizes, key=lambda size: -size[0] * size[1]):
        if cv2.findChessboardCorners(small, (columns, rows), flags=_QUICK)[0]:
            return columns, rows
    return None


def _search(image: Image, size: tuple[int, int]) -> Array | None:
    """Corners in any of the orders that fit the size.

    The quadrangle search is quick and needs no wide white margin; the sector search sees more
    under strong tilt or blur, and needs its exhaustive mode where the surroundings are dark.
    """
    attempts = [(longest_px, cv2.findChessboardCorners, _QUICK) for longest_px in _SEARCH_PX]
    attempts.append((_THOROUGH_PX, cv2.findChessboardCornersSB, _THOROUGH))
    for longest_px, search, flags in attempts:
        small = _reduced(image, longest_px)
        is_found, corners = search(small, size, flags=flags)
        if is_found:
            ratio = np.array([image.shape[1] / small.shape[1], image.shape[0] / small.shape[0]])
            # Pixel centres lie at integers, so the image's corner is at -0.5 at every scale.
            return np.asarray((corners.reshape(-1, 2) + 0.5) * ratio - 0.5, dtype=float)
    return None


def _reduced(image: Image, longest_px: int) -> Image:
    scale = max(image.shape) / longest_px
    if scale <= 1:
        return image
    shape = (round(image.shape[1] / scale), round(image.shape[0] / scale))
    return np.asarray(cv2.resize(image, shape, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _right_handed(grid: Array) -> Array:
    """Mirror the rows if need be, so that rows and columns turn like x and y of the image."""
    along_row, along_column = grid[-1, -1] - grid[-1, 0], grid[-1, 0] - grid[0, 0]
    area = along_row[0] * along_column[1] - along_row[1] * along_column[0]
    return grid if area > 0 else grid[:, ::-1]


def _side_that_continues(image: Image, grid: Array) -> str | None:
    """The side of the grid, in the image, beyond which the pattern goes on; None if none does."""
    for quarter in range(4):
        turned = np.rot90(grid, quarter)
        last, before, earlier = turned[0], turned[1], turned[2]
        across, along = (last - before) / 4, np.gradient(last, axis=0) / 4
        # Quadratic extrapolation: under perspective the distance between lines of corners changes.
        beyond = 3 * last - 3 * before + earlier
        own = _contrast(image, last, across, along)
        outside = _contrast(image, beyond, across, along)
        seen = np.isfinite(own) & np.isfinite(outside)
        if seen.sum() * 2 < len(last):
            continue
        # Colours alternate: a further line of corners has the opposite sign.
        ratio = -float((outside[seen] * np.sign(own[seen])).sum() / np.abs(own[seen]).sum())
        if ratio > _CONTINUES:
            return _side(np.mean(last - before, axis=0))
    return None


def _side(outwards: Array) -> str:
    """The name of the side of the image to which a direction points most."""
    x, y = outwards
    if abs(x) > abs(y):
        return "right" if x > 0 else "left"
    return "lower" if y > 0 else "upper"


def _contrast(image: Image, corners: Array, across: Array, along: Array) -> Array:
    """Brightness of one pair of opposite squares about each corner less that of the other."""
    signs = ((1, 1, 1), (-1, -1, 1), (1, -1, -1), (-1, 1, -1))
    total = np.zeros(len(corners))
    for across_sign, along_sign, sign in signs:
        total += sign * _sample(image, corners + across_sign * across + along_sign * along)
    return total


def _sample(image: Image, points: Array) -> Array:
    """Grey values at points, shape (..., 2); not a number outside the image."""
    columns, rows = np.moveaxis(np.rint(points).astype(int), -1, 0)
    inside = (columns >= 0) & (rows >= 0) & (columns < image.shape[1]) & (rows < image.shape[0])
    values = np.full(columns.shape, np.nan)
    values[inside] = image[rows[inside], columns[inside]]
    return values


def _first_cell_is_dark(image: Image, grid: Array) -> bool:
    """Whether the square between the first four corners is darker than its neighbours."""
    middles = (grid[:-1, :-1] + grid[1:, 1:] + grid[:-1, 1:] + grid[1:, :-1]) / 4
    values = _sample(image, middles)
    parity = np.add.outer(np.arange(values.shape[0]), np.arange(values.shape[1])) % 2
    return bool(np.nanmean(values[parity == 0]) < np.nanmean(values[parity == 1]))
