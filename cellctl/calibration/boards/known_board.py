"""A board that was measured before: where the next calibration with it begins.

What a calibration has found of the shape of its board is in its record: the corners, which of its
deviations were released, and how well each of them was determined. The next calibration takes the
corners for the drawing, and every deviation from them for as small as it was determined, and as
boards stay: they bend a little otherwise when they are carried, and with temperature.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.board_record import board_from_record, corners_from_record
from cellctl.calibration.boards.board_shape import BoardShape, ShapeModes, shape_modes
from cellctl.errors.calibration import KnownBoardDiffers
from cellctl.geometry.pose import Array

_STAYS = 0.05
"""How far a known board may have changed, as a share of the prior of an unknown one: 10 µm of
bow."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundShape:
    """What a calibration released of its board, and how well it was determined."""

    released: BoardShape
    sigma: Array
    """Standard deviation of each of the modes of ``shape_modes``, shape (m,)."""


@dataclass(frozen=True, slots=True, eq=False)
class KnownBoard:
    """A board as an earlier calibration found it."""

    board: CalibrationBoard
    corners_m: Array
    """Shape (n, 3)."""
    found: FoundShape | None
    """The shape that was found; None in records of older versions, whose corners are only a
    start."""


def found_shape_to_record(found: FoundShape | None) -> dict[str, Any]:
    """Plain data; sigmas in metres or relative, as the modes are."""
    if found is None:
        return {"board_shape": None, "board_shape_sigma": None}
    return {"board_shape": found.released.value, "board_shape_sigma": found.sigma.tolist()}


def found_shape_from_record(record: Mapping[str, Any]) -> FoundShape | None:
    """The inverse; None for a record of an older version."""
    if record.get("board_shape") is None:
        return None
    sigma = np.asarray(record["board_shape_sigma"], dtype=float)
    if sigma.ndim != 1 or not (np.isfinite(sigma).all() and (sigma >= 0).all()):
        raise ValueError("board_shape_sigma must hold finite standard deviations")
    return FoundShape(BoardShape(record["board_shape"]), sigma)


def known_board_from_record(record: Mapping[str, Any]) -> KnownBoard:
    """The board in the record of a calibration of a head or a camera.

    Raises ``KeyError``, ``TypeError`` or ``ValueError``.
    """
    board = board_from_record(record["board"])
    corners_m = corners_from_record(record)
    if corners_m.shape != board.corners_m.shape or not np.isfinite(corners_m).all():
        raise ValueError(f"board_corners_mm are not the corners of a {board}")
    return KnownBoard(board, corners_m, found_shape_from_record(record))


def shape_to_adjust(
    board: CalibrationBoard,
    shape: BoardShape,
    known: KnownBoard | None,
    *,
    turns_known: bool = False,
) -> tuple[Array, ShapeModes]:
    """The corners that a calibration starts from, shape (n, 3), and what it releases of them.

    ``turns_known`` as in ``shape_modes``. Raises ``KnownBoardDiffers``.
    """
    modes = shape_modes(board, shape, turns_known=turns_known)
    if known is None:
        return board.corners_m, modes
    if not _same(known.board, board):
        raise KnownBoardDiffers(f"known is the {known.board}, given the {board}")
    # Of a board that hides a turn, heads and cameras release other modes, which cannot be compared.
    one_by_one = len(board.quarter_turns) == 1 or (
        known.found is not None
        and known.found.released is shape
        and len(known.found.sigma) == len(modes.sigma)
    )
    if known.found is None or not one_by_one:
        return known.corners_m, modes
    return known.corners_m, ShapeModes(modes.modes, _narrowed(modes, shape, known.found))


def _same(one: CalibrationBoard, other: CalibrationBoard) -> bool:
    """Whether they are one board but for rounding in a file."""
    if str(one) != str(other):
        return False
    sizes = [(one.square_m, other.square_m)]
    if one.charuco is not None and other.charuco is not None:
        if one.charuco.dictionary != other.charuco.dictionary:
            return False
        sizes.append((one.charuco.marker_m, other.charuco.marker_m))
    if one.circles is not None and other.circles is not None:
        sizes.append((one.circles.diameter_m, other.circles.diameter_m))
    return all(np.isclose(*pair, rtol=1e-9, atol=0.0) for pair in sizes)


def _narrowed(modes: ShapeModes, shape: BoardShape, found: FoundShape) -> Array:
    """Priors of deviations from a known board."""
    sigma = modes.sigma.copy()
    is_height = np.abs(modes.modes[:, 2]).max(axis=0) > 0
    # Heights come first and are the same modes in every shape that has them. Modes of the print are
    # known only to a calibration that released the same ones.
    same = np.ones(len(sigma), dtype=np.bool_) if shape is found.released else is_height
    same &= np.arange(len(sigma)) < len(found.sigma)
    determined = np.hypot(found.sigma[: same.sum()], _STAYS * sigma[same])
    sigma[same] = np.minimum(determined, sigma[same])
    return sigma
