"""Printed patterns of rectangular fields, and their exact picture through lens and bow."""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.render.canvas import Image
from fakes.render.coverage import half_plane
from fakes.render.lens import Array
from fakes.render.model import SceneCharucoBoard
from fakes.world.scene import SceneChessboard

_LOOKUP: Final = 16384


@dataclass(frozen=True, slots=True)
class Print:
    """A pattern of rectangular fields between straight lines, with its outline."""

    lines_x: Array
    lines_y: Array
    white: NDArray[np.bool_]
    """Shape (len(lines_y) + 1, len(lines_x) + 1): fields between the lines and outside of them."""


def chessboard_print(board: SceneChessboard) -> Print:
    """Fields of a chessboard; the one at −x, −y is black."""
    columns, rows = (count + 1 for count in board.inner_corners)
    lines_x = np.linspace(-0.5, 0.5, columns + 1) * columns * board.square_m
    lines_y = np.linspace(-0.5, 0.5, rows + 1) * rows * board.square_m
    white = np.ones((rows + 2, columns + 2), dtype=bool)
    white[1:-1, 1:-1] = np.add.outer(np.arange(rows), np.arange(columns)) % 2 == 1
    return Print(lines_x, lines_y, white)


def charuco_print(board: SceneCharucoBoard) -> Print:
    """Fields of a ChArUco board, down to the bits of its markers."""
    dictionary = cv2.aruco.getPredefinedDictionary(board.dictionary)
    layout = cv2.aruco.CharucoBoard(board.squares, board.square_m, board.marker_m, dictionary)
    bits = dictionary.markerSize + 2
    inside = (board.square_m - board.marker_m) / 2 + np.arange(bits + 1) * board.marker_m / bits
    steps = np.concatenate([[0.0], inside])
    columns, rows = board.squares
    lines_x = _all_lines(columns, board.square_m, steps)
    lines_y = _all_lines(rows, board.square_m, steps)
    per_square = len(steps)
    square = np.add.outer(np.arange(rows), np.arange(columns)) % 2 == 1
    fields = np.kron(square, np.ones((per_square, per_square), dtype=bool)).astype(bool)
    for number, corners in zip(np.ravel(layout.getIds()), layout.getObjPoints(), strict=True):
        column, row = (np.mean(corners, axis=0)[:2] // board.square_m).astype(int)
        marker = cv2.aruco.generateImageMarker(dictionary, int(number), bits) > 0
        top, left = row * per_square + 1, column * per_square + 1
        fields[top : top + bits, left : left + bits] = marker
    white = np.ones((len(lines_y) + 1, len(lines_x) + 1), dtype=bool)
    white[1:-1, 1:-1] = fields[::-1]
    return Print(lines_x, -lines_y[::-1], white)


def _all_lines(count: int, square_m: float, steps: Array) -> Array:
    starts = (np.arange(count) - count / 2) * square_m
    return np.append(np.add.outer(starts, steps).ravel(), count / 2 * square_m)


def print_grey(pattern: Print, x_m: Array, y_m: Array, *, sub: int) -> Image:
    """Part of white in every pixel; ``x_m``, ``y_m`` are surface coordinates of the pixels.

    Away from edges a pixel has the field at its middle. Where a neighbour differs, the pixel is
    divided into ``sub`` × ``sub`` cells, each with its exact share beyond the nearest lines.
    """
    column = _lookup(pattern.lines_x, x_m)
    row = _lookup(pattern.lines_y, y_m)
    field = pattern.white.astype(np.uint8)[row, column]
    kernel = np.ones((3, 3), np.uint8)
    at_edge = cv2.dilate(field, kernel) != cv2.erode(field, kernel)
    at_edge[[0, -1]] = False
    at_edge[:, [0, -1]] = False
    rows, columns = np.nonzero(at_edge)
    grey = field.astype(np.float32)
    side_x, share_x = _beyond(pattern.lines_x, x_m, rows, columns, sub)
    side_y, share_y = _beyond(pattern.lines_y, y_m, rows, columns, sub)
    white = pattern.white.astype(np.float64)
    low, high = white[side_y, side_x][:, None], white[side_y + 1, side_x][:, None]
    at_left = low + share_y * (high - low)
    low, high = white[side_y, side_x + 1][:, None], white[side_y + 1, side_x + 1][:, None]
    at_right = low + share_y * (high - low)
    grey[rows, columns] = (at_left + share_x * (at_right - at_left)).mean(axis=1)
    return grey


def _beyond(
    lines: Array, coordinate: Array, rows: NDArray[np.intp], columns: NDArray[np.intp], sub: int
) -> tuple[NDArray[np.intp], Array]:
    """For pixels (N): index of the nearest line, and the share of each cell (N, sub²) beyond it."""
    here = coordinate[rows, columns]
    slope_x = (coordinate[rows, columns + 1] - coordinate[rows, columns - 1]) / 2
    slope_y = (coordinate[rows + 1, columns] - coordinate[rows - 1, columns]) / 2
    middles = (lines[1:] + lines[:-1]) / 2
    nearest = np.searchsorted(middles, here)
    length = np.hypot(slope_x, slope_y)
    normal_x, normal_y = slope_x / length, slope_y / length
    offset = (np.arange(sub) + 0.5) / sub - 0.5
    cell_y, cell_x = (axis.ravel() for axis in np.meshgrid(offset, offset, indexing="ij"))
    distance = ((here - lines[nearest]) / length)[:, None]
    distance = distance + np.outer(normal_x, cell_x) + np.outer(normal_y, cell_y)
    return nearest, half_plane(distance * sub, normal_x[:, None], normal_y[:, None])


def _lookup(lines: Array, coordinate: Array) -> NDArray[np.int16]:
    """Index of the field of each coordinate, right except within a hair of a line."""
    start, stop = lines[0] - 1e-3, lines[-1] + 1e-3
    step = (stop - start) / _LOOKUP
    table = np.searchsorted(lines, start + (np.arange(_LOOKUP) + 0.5) * step).astype(np.int16)
    place = ((coordinate - start) / step).astype(np.int32)
    return np.asarray(table[np.clip(place, 0, _LOOKUP - 1)])
