"""Views of a small bent board in a camera with a long lens."""

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CalibrationBoard, CameraView, Corners
from cellctl.calibration.boards.projection import project
from cellctl.geometry.pose import Array

BOARD = CalibrationBoard(11, 8, 1.5e-3)
IMAGE_SIZE = (2048, 1088)
CAMERA = np.array([8330.0, 8335.0, 1021.0, 547.0, -0.08, 0.05, 2e-4, -1e-4, 0.0])
"""25 mm lens, 30 µm per pixel at 250 mm."""
DISTANCE_M = 0.25
BOW_M = 4e-6
_FACING = Rotation.from_euler("x", 180, degrees=True)


def bent_board_m(rng: np.random.Generator, board: CalibrationBoard = BOARD) -> Array:
    """Corners, shape (n, 3): bowed along and across by up to ``BOW_M``."""
    corners = board.corners_m.copy()
    sides = corners[:, :2] / np.abs(corners[:, :2]).max(axis=0)
    corners[:, 2] = sides**2 @ rng.uniform(-BOW_M, BOW_M, 2)
    return corners


def camera_views(
    rng: np.random.Generator,
    count: int = 30,
    *,
    noise_px: float = 0.03,
    tilt_deg: float = 20.0,
    board: CalibrationBoard = BOARD,
) -> list[CameraView]:
    """Views that have the whole board in the picture."""
    board_m = bent_board_m(rng, board)
    views: list[CameraView] = []
    while len(views) < count:
        angles = rng.uniform(-1, 1, 3) * (40.0, tilt_deg, tilt_deg)
        rotation = Rotation.from_euler("ZYX", angles, degrees=True) * _FACING
        shift_m = rng.uniform(-1, 1, 3) * (18e-3, 6e-3, 20e-3) + (0, 0, DISTANCE_M)
        pixels = project(CAMERA, rotation.apply(board_m) + shift_m).pixels
        if (pixels > 5).all() and (pixels < np.array(IMAGE_SIZE) - 5).all():
            noisy = pixels + rng.normal(0, noise_px, pixels.shape)
            corners = Corners(np.arange(len(board_m)), noisy)
            views.append(CameraView(f"view {len(views) + 1}", corners))
    return views
