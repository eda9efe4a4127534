"""How well the views of a calibration cover the image of one camera, and tilt the board."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard, Corners
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


def coverage_to_record(coverage: Coverage) -> dict[str, Any]:
    """Plain data."""
    return {
        "corners_per_cell": coverage.cells.astype(int).tolist(),
        "filled_ratio": coverage.filled_ratio,
        "tilt_ratio": coverage.tilt_ratio,
    }


def coverage_from_record(record: Mapping[str, Any]) -> Coverage:
    """The inverse of ``coverage_to_record``."""
    cells = np.asarray(record["corners_per_cell"], dtype=float)
    return Coverage(cells, float(record["filled_ratio"]), float(record["tilt_ratio"]))
