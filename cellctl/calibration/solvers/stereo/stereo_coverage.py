"""Coverage of the views of a stereo calibration, judged before anything is solved."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.calibration.boards.board import BoardView, CalibrationBoard, Corners
from cellctl.calibration.checks import LimitCheck
from cellctl.errors.calibration import PoorCoverage, TooFewViews
from cellctl.geometry.pose import Array

CELLS = (8, 6)
"""The image is divided into so many columns and rows."""


@dataclass(frozen=True, slots=True, eq=False)
class Coverage:
    """Figures of one camera."""

    cells: Array
    """Corners per image cell, shape (6, 8)."""
    filled_ratio: float
    """Cells with at least one corner."""
    tilt_ratio: float
    """Rms change of scale across the board in the weakest direction: 0 for boards that always
    face the camera, which leave focal length and distance apart undetermined."""


@dataclass(frozen=True, slots=True)
class CoverageLimits:
    """Least coverage below which nothing is solved."""

    views: int = 8
    filled_ratio: float = 0.4
    tilt_ratio: float = 0.015


def check_coverage(
    views: Sequence[BoardView],
    board: CalibrationBoard,
    image_size: tuple[int, int],
    limits: CoverageLimits,
) -> tuple[Coverage, Coverage, tuple[LimitCheck, ...]]:
    """Coverage of both cameras and the checks; ``TooFewViews`` or ``PoorCoverage`` if refused."""
    if len(views) < limits.views:
        names = ", ".join(view.name for view in views) or "none"
        raise TooFewViews(f"{len(views)} usable views, at least {limits.views} needed: {names}")
    left = coverage([view.left for view in views], board, image_size)
    right = coverage([view.right for view in views], board, image_size)
    checks = (
        LimitCheck("views", len(views), limits.views, "", "min"),
        _worst("image cells with corners", "filled_ratio", left, right, limits.filled_ratio),
        _worst("tilt of the board", "tilt_ratio", left, right, limits.tilt_ratio),
    )
    # Refused before solving: a solution from such views exists, has small residuals, and is wrong.
    failed = [str(check) for check in checks if not check.passed]
    if failed:
        raise PoorCoverage("; ".join(failed))
    return left, right, checks


def coverage(
    images: Sequence[Corners], board: CalibrationBoard, image_size: tuple[int, int]
) -> Coverage:
    """Coverage of one camera."""
    pixels = np.concatenate([corners.pixels for corners in images])
    bounds = ((-0.5, image_size[1] - 0.5), (-0.5, image_size[0] - 0.5))
    cells, _, _ = np.histogram2d(
        pixels[:, 1], pixels[:, 0], bins=(CELLS[1], CELLS[0]), range=bounds
    )
    slopes = np.stack([_foreshortening(corners, board) for corners in images])
    # The weakest direction counts: boards tilted about one axis only leave the other undetermined.
    weakest = float(np.linalg.eigvalsh(slopes.T @ slopes / len(slopes))[0])
    return Coverage(cells, float((cells > 0).mean()), float(np.sqrt(max(weakest, 0.0))))


def _foreshortening(corners: Corners, board: CalibrationBoard) -> Array:
    """Relative change of distance from the board's middle to its mean half side, along x and y.

    Comes from the homography's last row, so it needs no camera parameters.
    """
    flat = board.corners_m[:, :2]
    half = float(np.abs(flat).max(axis=0).mean())
    homography, _ = cv2.findHomography(flat[corners.ids] / half, corners.pixels)
    if homography is None:
        return np.zeros(2)
    matrix = np.asarray(homography, dtype=float)
    return np.asarray(matrix[2, :2] / matrix[2, 2])


def _worst(name: str, field: str, left: Coverage, right: Coverage, limit: float) -> LimitCheck:
    value = min(float(getattr(left, field)), float(getattr(right, field)))
    return LimitCheck(name, value, limit, "", "min")
