"""Finds a grid of circles in an image, with its circles in the board's own order."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.corners.circle_centres import Rims
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_SEARCH_PX = (1000, 2000)
"""Longer side of the reduced images in which circles are searched."""
_NEIGHBOURHOODS = (0.15, 0.05, 0.4)
"""Sizes of the surroundings that a pixel is compared with, as shares of the longer side: wider than
a circle, and narrower than the changes of the light."""
_SMALLEST_PX = 3.0
"""Radius in the reduced image; smaller spots have no shape."""
_THINNEST = 0.3
"""Minor over major axis: a board that is tilted by more than 70° is not measured."""
_ROUGHEST = 0.12
"""Rms distance of a contour from its ellipse over the minor half axis, with a pixel for free."""
_SAME_PLACE = 0.3
"""Largest distance of a circle from where a plane board would have it, as a share of the pitch in
the image."""
_ANY_SIZE = (0.25, 4.0)
"""Area of a circle over that of the typical one; perspective does not change it by more."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundGrid:
    """The grid in one image."""

    rims: Rims
    """The rims in the order of the board, to about a pixel."""
    bright: bool
    """Circles are brighter than the board."""
    mirrored: bool
    """True when only a mirrored image shows the board in this order."""


def find_circles(image: Image, board: CalibrationBoard) -> FoundGrid | None:
    """The whole grid, or None; a part of a larger grid is not taken."""
    longest_px = max(image.shape)
    for search_px in _SEARCH_PX:
        factor = max(longest_px / search_px, 1.0)
        shape = (round(image.shape[1] / factor), round(image.shape[0] / factor))
        small = cv2.resize(image, shape, interpolation=cv2.INTER_AREA) if factor > 1 else image
        ratio = np.array([image.shape[1] / shape[0], image.shape[0] / shape[1]])
        for share in _NEIGHBOURHOODS:
            block = round(share * max(small.shape)) | 1
            for bright in (False, True):
                spots = _spots(np.asarray(small, dtype=np.uint8), block, bright=bright)
                grid = _arranged(spots, board)
                if grid is not None:
                    order, mirrored = grid
                    # Pixel centres lie at integers, so the image's corner is at -0.5 at every
                    # scale.
                    centres = (spots.centres[order] + 0.5) * ratio - 0.5
                    axes = spots.half_axes[order] * ratio[:, None]
                    return FoundGrid(Rims(centres, axes), bright, mirrored)
        if factor <= 1:
            break
    return None


def _spots(image: Image, block: int, *, bright: bool) -> Rims:
    """Whatever looks like the image of a circle."""
    kind = cv2.THRESH_BINARY if bright else cv2.THRESH_BINARY_INV
    offset = -8 if bright else 8
    # The mean of the neighbourhood as threshold, because light is never even over a board.
    mask = cv2.adaptiveThreshold(image, 255, cv2.ADAPTIVE_THRESH_MEAN_C, kind, block, offset)
    contours, tree = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    centres, axes = [], []
    for contour, (_, _, _, parent) in zip(contours, np.reshape(tree, (-1, 4)), strict=False):
        # Outer borders only: the inner one of a ring belongs to the other brightness.
        if parent >= 0 or len(contour) < 4 * _SMALLEST_PX:
            continue
        (x, y), (width, height), angle_deg = cv2.fitEllipse(contour)
        minor, major = sorted((width / 2, height / 2))
        if minor < _SMALLEST_PX or minor < _THINNEST * major:
            continue
        turn = np.radians(angle_deg)
        vectors = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        vectors = vectors * (width / 2, height / 2)
        local = (contour[:, 0] - np.array([x, y])) @ np.linalg.inv(vectors).T
        rough = float(np.sqrt(np.mean((np.linalg.norm(local, axis=1) - 1) ** 2)))
        if rough <= _ROUGHEST / 2 + 0.5 / minor:
            centres.append((x, y))
            axes.append(vectors)
    return Rims(np.array(centres).reshape(-1, 2), np.array(axes).reshape(-1, 2, 2))


def _arranged(spots: Rims, board: CalibrationBoard) -> tuple[NDArray[np.intp], bool] | None:
    """Indices of the spots in the board's order, and whether the image is mirrored."""
    count = board.columns * board.rows
    if len(spots.centres) < count:
        return None
    area = np.abs(np.linalg.det(spots.half_axes))
    relative = area / np.sort(area)[-count // 2]
    alike = np.flatnonzero((relative > _ANY_SIZE[0]) & (relative < _ANY_SIZE[1]))
    if len(alike) < count:
        return None
    for mirrored in (False, True):
        points = spots.centres[alike]
        if mirrored:
            points = points * [-1.0, 1.0] + [points[:, 0].max(), 0.0]
        order = _order_of(points, board)
        if order is not None:
            return alike[order], mirrored
    return None


def _order_of(points: Array, board: CalibrationBoard) -> NDArray[np.intp] | None:
    """Indices of points, shape (n, 2), in the board's order, if they hold the grid."""
    asymmetric = board.circles is not None and board.circles.asymmetric
    kind = cv2.CALIB_CB_ASYMMETRIC_GRID if asymmetric else cv2.CALIB_CB_SYMMETRIC_GRID
    size = (board.columns, board.rows)
    given = points.astype(np.float32)[:, None]
    for flags in (kind, kind | cv2.CALIB_CB_CLUSTERING):
        try:
            # With parameters and without a detector it takes points in place of an image.
            is_found, centres = cv2.findCirclesGrid(  # type: ignore[call-overload] # no None there
                given, size, flags, None, cv2.CirclesGridFinderParameters()
            )
        except cv2.error:
            # It asserts on arrangements of points that are no grid.
            continue
        if not is_found or centres is None:
            continue
        places = np.reshape(centres, (-1, 1, 2))
        found = np.linalg.norm(places - points, axis=2).argmin(axis=1)
        order = _in_board_order(points, found, board)
        if order is not None:
            return order
    return None


def _in_board_order(
    points: Array, found: NDArray[np.intp], board: CalibrationBoard
) -> NDArray[np.intp] | None:
    """OpenCV may begin at any corner, and in mirrored order."""
    grid = found.reshape(board.rows, board.columns)
    for order in (grid, grid[::-1, ::-1], grid[::-1], grid[:, ::-1]):
        fit = _fitted(points[order.ravel()], board)
        # Columns and rows turn like x and y of the image, seen from the front of the board.
        if fit is not None and _turns_right(fit) and not _continues(points, fit, board):
            return order.ravel()
    return None


def _fitted(pixels: Array, board: CalibrationBoard) -> Array | None:
    """Homography from the board in units of its pitch to the image, if the circles fit it."""
    flat = board.corners_m[:, :2] / board.square_m
    found, _ = cv2.findHomography(flat, pixels)
    if found is None:
        return None
    matrix = np.asarray(found, dtype=float)
    moved = _moved(matrix, flat)
    pitch_px = np.median(
        np.linalg.norm(_moved(matrix, flat + np.array([1.0, 0.0])) - moved, axis=1)
    )
    # All together: a lens bends the grid at its ends, but a wrong order puts every circle wrong.
    off_px = np.sqrt(((moved - pixels) ** 2).sum(axis=1).mean())
    return matrix if off_px < _SAME_PLACE * pitch_px else None


def _moved(matrix: Array, points: Array) -> Array:
    moved = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return np.asarray(moved[:, :2] / moved[:, 2:])


def _turns_right(matrix: Array) -> bool:
    corners = _moved(matrix, np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    (ax, ay), (bx, by) = corners[1] - corners[0], corners[2] - corners[0]
    return bool(ax * by - ay * bx > 0)


def _continues(centres: Array, matrix: Array, board: CalibrationBoard) -> bool:
    """Whether the grid goes on beyond one of its four sides."""
    flat = board.corners_m[:, :2] / board.square_m
    asymmetric = board.circles is not None and board.circles.asymmetric
    for axis in (0, 1):
        step = np.zeros(2)
        step[axis] = 2.0 if asymmetric else 1.0
        for sign in (-1.0, 1.0):
            edge = flat[np.isclose(flat[:, axis], sign * np.abs(flat[:, axis]).max())]
            beyond = _moved(matrix, edge + sign * step)
            pitch_px = np.linalg.norm(beyond - _moved(matrix, edge), axis=1)
            nearest = np.linalg.norm(beyond[:, None] - centres[None], axis=2).min(axis=1)
            if (nearest < _SAME_PLACE * pitch_px).mean() > 0.7:
                return True
    return False
