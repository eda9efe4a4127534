"""Calibration boards, what a head sees of them, and how a board may be bent.

Board frame: origin in the middle of the inner corners, x along a row, y along a column. Corner
``row * columns + column`` is at ``((column - (columns-1)/2) * square, ..., 0)`` on a flat board.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import null_space

from cellctl.geometry.pose import Array

Ids = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Charuco:
    """The markers in the white squares of a ChArUco board."""

    dictionary: str
    """OpenCV's name without its prefix, for example ``5X5_100``."""
    marker_m: float


@dataclass(frozen=True, slots=True)
class CalibrationBoard:
    """A chessboard, or a ChArUco board if it has markers."""

    columns: int
    """Inner corners in a row."""
    rows: int
    square_m: float
    charuco: Charuco | None = None

    def __post_init__(self) -> None:
        if self.columns < 3 or self.rows < 3 or not self.square_m > 0:
            raise ValueError("a board needs at least 3 x 3 inner corners and a positive square")

    @property
    def symmetric(self) -> bool:
        """True when turning a chessboard by 180° gives the same colours."""
        return self.charuco is None and (self.columns + self.rows) % 2 == 0

    @property
    def corners_m(self) -> Array:
        """Corners of the flat board, shape (rows * columns, 3)."""
        x = (np.arange(self.columns) - (self.columns - 1) / 2) * self.square_m
        y = (np.arange(self.rows) - (self.rows - 1) / 2) * self.square_m
        grid_x, grid_y = np.meshgrid(x, y)
        return np.stack([grid_x.ravel(), grid_y.ravel(), np.zeros(grid_x.size)], axis=1)

    def __str__(self) -> str:
        kind = "chessboard" if self.charuco is None else "ChArUco board"
        return f"{self.columns} x {self.rows} {kind}, {self.square_m * 1e3:g} mm squares"


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """Corners of a board in one image."""

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


class BoardShape(Enum):
    """The freedom of the board's shape in an adjustment. Its scale always stays the drawing's."""

    RIGID = "rigid"
    """The drawing is exact. A bow of 0.1 mm ruins the result without showing in the residuals."""
    BENT = "bent"
    """Flatness is released: a smooth surface up to fourth order."""
    FREE = "free"
    """Flatness, and the aspect ratio and squareness of the print."""
    PRINTED = "printed"
    """Flatness, and the place of every corner of the print by itself."""


BEND_SIGMA_M = 2e-4
"""Prior of each mode of flatness: generous for anything that is called a board."""
PRINT_SIGMA = 2e-4
"""Prior of aspect ratio and squareness, relative."""
CORNER_SIGMA_M = 3e-5
"""Prior of a coordinate of a printed corner: what feed and paper of a printer leave."""


@dataclass(frozen=True, slots=True, eq=False)
class ShapeModes:
    """Small deviations of a board: corners = flat corners + modes @ parameters."""

    modes: Array
    """Shape (corners, 3, m)."""
    sigma: Array
    """Prior standard deviation of each parameter, shape (m,)."""


def shape_modes(board: CalibrationBoard, shape: BoardShape) -> ShapeModes:
    """The modes that ``shape`` releases; none of them is a motion or a scale of the board."""
    flat = board.corners_m
    columns: list[Array] = []
    sigma: list[float] = []
    if shape is not BoardShape.RIGID:
        u = flat[:, 0] / np.abs(flat[:, 0]).max()
        v = flat[:, 1] / np.abs(flat[:, 1]).max()
        # Legendre polynomials are nearly orthogonal on the grid, so the heights of the modes can be
        # told apart one by one.
        for i, j in _orders(board):
            height = legendre.legval(u, np.eye(5)[i]) * legendre.legval(v, np.eye(5)[j])
            columns.append(np.outer(height, [0.0, 0.0, 1.0]))
            # Boards bend smoothly: the higher the order, the smaller it is.
            sigma.append(BEND_SIGMA_M / (i + j - 1))
    if shape is BoardShape.FREE:
        # Stretched along x and shrunk along y, so that the scale of the board stays the drawing's:
        # images alone cannot tell it.
        columns.append(flat * [0.5, -0.5, 0.0])
        columns.append(flat[:, [1, 0, 2]] * [0.5, 0.5, 0.0])
        sigma += [PRINT_SIGMA, PRINT_SIGMA]
    if shape is BoardShape.PRINTED:
        columns += list(_print_modes(flat))
        sigma += [CORNER_SIGMA_M] * (2 * len(flat) - 4)
    modes = np.stack(columns, axis=2) if columns else np.zeros((len(flat), 3, 0))
    return ShapeModes(modes, np.array(sigma))


def _print_modes(flat: Array) -> Array:
    """Displacements of the corners within the plane, orthonormal, shape (2 n - 4, n, 3)."""
    x, y = flat[:, :2].T
    one, zero = np.ones_like(x), np.zeros_like(x)
    # A shift, a turn and a scale of the whole print are the board's pose and the drawing's scale.
    held = np.stack(
        [np.concatenate(field) for field in ((one, zero), (zero, one), (-y, x), (x, y))]
    )
    free = null_space(held).T.reshape(-1, 2, len(flat))
    modes = np.zeros((len(free), len(flat), 3))
    modes[:, :, :2] = free.transpose(0, 2, 1)
    return modes


def _orders(board: CalibrationBoard) -> list[tuple[int, int]]:
    """Orders of the flatness modes that the grid can carry: total degree 2 to 4."""
    return [
        (i, j)
        for i in range(5)
        for j in range(5)
        # Degrees 0 and 1 are a shift and a tilt of the board, which its pose already contains.
        if 2 <= i + j <= 4 and i < board.columns and j < board.rows
    ]
