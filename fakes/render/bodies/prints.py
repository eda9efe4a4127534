"""Printed patterns of rectangular fields, and their exact picture through lens and bow."""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from fakes.render.model import SceneCharucoBoard
from fakes.render.optics.canvas import Image
from fakes.render.optics.coverage import half_plane
from fakes.render.optics.lens import Array
from fakes.render.optics.sensor import REACH
from fakes.world.scene import SceneChessboard

_LOOKUP: Final = 16384
_PIXEL_VARIANCE: Final = 1 / 12


@dataclass(frozen=True, slots=True, eq=False)
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
        # Drawn bit by bit as fields, so that markers have the same exact edges as the squares.
        fields[top : top + bits, left : left + bits] = marker
    white = np.ones((len(lines_y) + 1, len(lines_x) + 1), dtype=bool)
    # OpenCV counts the rows of a board downwards, this board has y upwards.
    white[1:-1, 1:-1] = fields[::-1]
    return Print(lines_x, -lines_y[::-1], white)


def _all_lines(count: int, square_m: float, steps: Array) -> Array:
    starts = (np.arange(count) - count / 2) * square_m
    return np.append(np.add.outer(starts, steps).ravel(), count / 2 * square_m)


def white_share(pattern: Print, x_m: Array, y_m: Array, blur_px: float) -> Image:
    """Share of white in every pixel, blur included; ``x_m``, ``y_m`` are the pixels' coordinates.

    Away from edges it is the field at the pixel's middle. Near edges the lines are straight over
    the reach of the blur, so that the convolution with Gaussian and pixel box has a closed form;
    where two lines cross, their shares are correlated by the cosine between their normals.
    """
    column = _lookup(pattern.lines_x, x_m)
    row = _lookup(pattern.lines_y, y_m)
    field = pattern.white.astype(np.uint8)[row, column]
    reach = 1 + int(np.ceil(REACH * blur_px))
    kernel = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    # Only pixels with another field within reach of the blur are computed; all others are plain
    # black or white.
    places = np.nonzero(cv2.dilate(field, kernel) != cv2.erode(field, kernel))
    side_x = _nearest_line(pattern.lines_x, x_m, *places)
    side_y = _nearest_line(pattern.lines_y, y_m, *places)
    white = pattern.white.astype(np.float64)
    near_near, near_far = white[side_y.index, side_x.index], white[side_y.index, side_x.index + 1]
    far_near = white[side_y.index + 1, side_x.index]
    far_far = white[side_y.index + 1, side_x.index + 1]
    share_x, share_y = side_x.share(blur_px), side_y.share(blur_px)
    near = near_near + share_x * (near_far - near_near)
    far = far_near + share_x * (far_far - far_near)
    # Where two lines cross at an angle, the share beyond both is not the product of the single
    # shares.
    saddle = far_far - far_near - near_far + near_near
    value = near + share_y * (far - near) + saddle * _crossing(side_x, side_y, blur_px)
    result = field.astype(np.float32)
    result[places] = value
    return result


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """The nearest line of each of N pixels."""

    index: NDArray[np.intp]
    distance: Array
    """Distance of the pixel's middle beyond the line, px."""
    normal_x: Array
    normal_y: Array

    def share(self, blur_px: float) -> Array:
        """Share of the pixel beyond the line."""
        if blur_px <= 0:
            # Without blur only the pixel's box is left, for which there is an exact formula.
            return half_plane(self.distance, self.normal_x, self.normal_y)
        # The pixel's own box has a variance of 1/12. Adding it to that of the Gaussian gives the
        # right width; the next term corrects the shape, because a box has lighter tails than a
        # Gaussian.
        sigma2 = blur_px**2 + _PIXEL_VARIANCE
        z = self.distance / np.sqrt(sigma2)
        excess = -(self.normal_x**4 + self.normal_y**4) / (120 * sigma2**2)
        return np.asarray(ndtr(z) - excess / 24 * (z**3 - 3 * z) * _normal_density(z))


def _crossing(first: _Line, second: _Line, blur_px: float) -> Array:
    """Share beyond both lines less the product of their single shares (Mehler's series)."""
    if blur_px <= 0:
        return np.zeros_like(first.distance)
    sigma = np.sqrt(blur_px**2 + _PIXEL_VARIANCE)
    u, v = first.distance / sigma, second.distance / sigma
    cosine = first.normal_x * second.normal_x + first.normal_y * second.normal_y
    series = 1 + cosine / 2 * u * v + cosine**2 / 6 * (u**2 - 1) * (v**2 - 1)
    return np.asarray(cosine * series * _normal_density(u) * _normal_density(v))


def _nearest_line(
    lines: Array, coordinate: Array, rows: NDArray[np.intp], columns: NDArray[np.intp]
) -> _Line:
    here = coordinate[rows, columns]
    up, down = np.maximum(rows - 1, 0), np.minimum(rows + 1, coordinate.shape[0] - 1)
    left, right = np.maximum(columns - 1, 0), np.minimum(columns + 1, coordinate.shape[1] - 1)
    slope_x = (coordinate[rows, right] - coordinate[rows, left]) / (right - left)
    slope_y = (coordinate[down, columns] - coordinate[up, columns]) / (down - up)
    length = np.hypot(slope_x, slope_y)
    nearest = np.searchsorted((lines[1:] + lines[:-1]) / 2, here)
    return _Line(nearest, (here - lines[nearest]) / length, slope_x / length, slope_y / length)


def _normal_density(z: Array) -> Array:
    return np.asarray(np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi))


def _lookup(lines: Array, coordinate: Array) -> NDArray[np.int16]:
    """Index of the field of each coordinate, right except within a hair of a line."""
    start, stop = lines[0] - 1e-3, lines[-1] + 1e-3
    step = (stop - start) / _LOOKUP
    # A table instead of a search for each of five million pixels. It is wrong only within a step of
    # a line, and pixels there are computed exactly afterwards.
    table = np.searchsorted(lines, start + (np.arange(_LOOKUP) + 0.5) * step).astype(np.int16)
    place = ((coordinate - start) / step).astype(np.int32)
    return np.asarray(table[np.clip(place, 0, _LOOKUP - 1)])
