"""Calibration boards, and what cameras see of them.

Board frame: origin in the middle of the inner corners, x along a row, y along a column. Corner
``row * columns + column`` is at ``((column - (columns-1)/2) * square, ..., 0)`` on a flat board.
On a grid of circles their centres take the place of the corners.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array

Ids = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Charuco:
    """The markers in the white squares of a ChArUco board."""

    dictionary: str
    """OpenCV's name without its prefix, for example ``5X5_100``."""
    marker_m: float


@dataclass(frozen=True, slots=True)
class Circles:
    """The circles of a grid, which take the place of the squares of a chessboard."""

    diameter_m: float
    asymmetric: bool = False
    """Every second row is moved by half the distance of two circles in a row. Columns, rows and
    pitch are OpenCV's then: circles in one row, number of rows, distance of the rows."""


@dataclass(frozen=True, slots=True)
class CalibrationBoard:
    """A chessboard, a ChArUco board if it has markers, or a grid of circles."""

    columns: int
    """Inner corners, or circles, in a row."""
    rows: int
    square_m: float
    """Side of a square, or pitch of a grid of circles."""
    charuco: Charuco | None = None
    circles: Circles | None = None

    def __post_init__(self) -> None:
        if self.columns < 3 or self.rows < 3 or not self.square_m > 0:
            raise ValueError("a board needs at least 3 x 3 inner corners and a positive square")
        if self.circles is None:
            return
        if self.charuco is not None:
            raise ValueError("a board has markers or circles, not both")
        nearest_m = self.square_m * (np.sqrt(2) if self.circles.asymmetric else 1.0)
        if not 0 < self.circles.diameter_m < nearest_m:
            raise ValueError("circles must be smaller than their distance, or they touch")

    @property
    def quarter_turns(self) -> tuple[int, ...]:
        """Quarter turns after which an image of the board could not tell that it was turned."""
        same = [0]
        for quarters in (1, 2, 3):
            if quarters == 2 or self.columns == self.rows:
                same += [quarters] * self._looks_the_same(quarters)
        return tuple(same)

    @property
    def symmetric(self) -> bool:
        """True when the board looks the same after a turn by 180°."""
        return 2 in self.quarter_turns

    @property
    def corners_m(self) -> Array:
        """Corners, or centres of circles, of the flat board, shape (rows * columns, 3)."""
        column, row = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        if self.circles is not None and self.circles.asymmetric:
            column = 2 * column + row % 2
        places = np.stack([column.ravel(), row.ravel(), np.zeros(column.size)], axis=1)
        middle = (places.min(axis=0) + places.max(axis=0)) / 2
        return np.asarray((places - middle) * self.square_m)

    def turned_ids(self, quarters: int) -> Ids:
        """Id of the corner that stands in the place of each one after so many quarter turns, for
        boards of which no image shows the turn."""
        flat = self.corners_m[:, :2]
        turned = flat @ np.linalg.matrix_power(np.array([[0.0, 1.0], [-1.0, 0.0]]), quarters)
        distances = np.linalg.norm(turned[:, None] - flat[None], axis=2)
        return np.asarray(distances.argmin(axis=1), dtype=np.int64)

    def _looks_the_same(self, quarters: int) -> bool:
        if self.charuco is not None:
            return False
        if self.circles is None:
            # The colours of a chessboard come back when the first corner lands on one of its own
            # colour; corners of neighbours have the colours exchanged.
            steps = self.columns - 1 + (self.rows - 1 if quarters == 2 else 0)
            return steps % 2 == 0
        return not self.circles.asymmetric or (quarters == 2 and self.rows % 2 == 0)

    def __str__(self) -> str:
        size = f"{self.columns} x {self.rows}"
        if self.circles is not None:
            kind = "asymmetric circle grid" if self.circles.asymmetric else "circle grid"
            return f"{size} {kind}, {self.square_m * 1e3:g} mm pitch"
        kind = "chessboard" if self.charuco is None else "ChArUco board"
        return f"{size} {kind}, {self.square_m * 1e3:g} mm squares"


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """Corners, or centres of circles, of a board in one image."""

    ids: Ids
    """Shape (n,), ascending."""
    pixels: Array
    """Shape (n, 2)."""


@dataclass(frozen=True, slots=True)
class BoardView:
    """The board as both cameras of a head see it in one exposure."""

    name: str
    left: Corners
    right: Corners


@dataclass(frozen=True, slots=True)
class CameraView:
    """The board as a single camera sees it in one exposure."""

    name: str
    corners: Corners
