"""How a board may deviate from its drawing: bent, and printed otherwise."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import null_space

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.geometry.pose import Array


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
_COMES_BACK = 0.5
"""Share of a mode from which on it counts as one that comes back. The mean over all turns leaves a
mode either whole (1) or not at all (0); this lies between them."""


@dataclass(frozen=True, slots=True, eq=False)
class ShapeModes:
    """Small deviations of a board: corners = flat corners + modes @ parameters."""

    modes: Array
    """Shape (corners, 3, m)."""
    sigma: Array
    """Prior standard deviation of each parameter, shape (m,)."""


def shape_modes(
    board: CalibrationBoard, shape: BoardShape, *, turns_known: bool = False
) -> ShapeModes:
    """The modes that ``shape`` releases; none of them is a motion or a scale of the board.

    ``turns_known`` says that all views name the corners of a board that looks the same after a
    turn from the same end of it.
    """
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
    released = ShapeModes(modes, np.array(sigma))
    return released if turns_known else _unchanged_by_turns(released, board)


def _unchanged_by_turns(shape: ShapeModes, board: CalibrationBoard) -> ShapeModes:
    """Only what comes back when the board is turned in a way that no image can tell.

    The views of such a board are turned among each other without anybody knowing. What differs
    from end to end would have to be both a deviation and its opposite.
    """
    turns = board.quarter_turns
    if len(turns) == 1 or not len(shape.sigma):
        return shape
    mean = np.zeros_like(shape.modes)
    for quarters in turns:
        ids, turn = board.turned_ids(quarters), np.eye(3)
        turn[:2, :2] = np.linalg.matrix_power(np.array([[0.0, 1.0], [-1.0, 0.0]]), quarters)
        mean[ids] += np.einsum("nkm,kl->nlm", shape.modes, turn) / len(turns)
    count = len(shape.sigma)
    flat = shape.modes.reshape(-1, count)
    # The mean over all turns in terms of the modes: it keeps what comes back, and of the rest
    # nothing is left.
    kept = np.linalg.lstsq(flat, mean.reshape(-1, count), rcond=None)[0]
    columns: list[Array] = []
    sigma: list[float] = []
    # Modes of one sort by themselves, because a mixture of two would need a prior of its own.
    sorts = np.stack([np.abs(shape.modes[:, 2]).max(axis=0) == 0, shape.sigma])
    for one in np.unique(sorts, axis=1).T:
        same = np.flatnonzero((one == sorts.T).all(axis=1))
        block = kept[np.ix_(same, same)]
        values, vectors = np.linalg.eigh((block + block.T) / 2)
        chosen = vectors[:, values > _COMES_BACK]
        columns.append(shape.modes[:, :, same] @ chosen)
        sigma += [float(one[1])] * chosen.shape[1]
    return ShapeModes(np.concatenate(columns, axis=2), np.array(sigma))


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
