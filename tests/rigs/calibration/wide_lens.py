"""Views of a board at corner level in a wide camera, with a lens of any number of terms."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board import BoardView, CalibrationBoard, CameraView, Corners
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead

BOARD = CalibrationBoard(11, 8, 0.03)
IMAGE_SIZE = (1280, 1024)
FIVE = (-0.12, 0.03, 4e-4, -3e-4, -0.004)
RATIONAL = (0.9, 0.1, 4e-4, -3e-4, 0.01, 1.1, 0.25, 0.02)
"""A lens of 95° that draws nearly by the angle."""
TILTED = (*RATIONAL, 2e-3, -4e-4, -1.5e-3, 3e-4, 0.03, -0.02)
"""The same before a sensor that stands askew by 2°."""


def camera(distortion: tuple[float, ...]) -> CameraModel:
    matrix = np.array([[640.0, 0.0, 645.0], [0.0, 641.0, 508.0], [0.0, 0.0, 1.0]])
    return CameraModel(matrix, np.array(distortion))


def camera_views(
    model: CameraModel, rng: np.random.Generator, count: int = 24, noise_px: float = 0.05
) -> list[CameraView]:
    """Views with at least half of the board in the picture."""
    views: list[CameraView] = []
    while len(views) < count:
        corners = seen(model, placed(rng), rng, noise_px)
        if len(corners.ids) >= 44:
            views.append(CameraView(f"view {len(views) + 1}", corners))
    return views


def placed(rng: np.random.Generator) -> RigidTransform:
    """camera_T_board: anywhere before the camera, tilted to all sides."""
    angles_deg = rng.uniform(-1, 1, 3) * (180.0, 35.0, 35.0)
    direction = np.array([*rng.uniform(-0.7, 0.7, 2), 1.0])
    rotation = Rotation.from_euler("ZYX", angles_deg, degrees=True)
    return RigidTransform.from_components(direction * rng.uniform(0.25, 0.5), rotation)


def seen(
    model: CameraModel, camera_T_board: RigidTransform, rng: np.random.Generator, noise_px: float
) -> Corners:
    points = np.asarray(camera_T_board.apply(BOARD.corners_m), dtype=float)
    rays = points[:, :2] / points[:, 2:]
    pixels = project(model, points)
    # Far outside of the picture a rational lens may fold back into it.
    inside = (np.linalg.norm(rays, axis=1) < 1.35) & (points[:, 2] > 0.05)
    inside &= ((pixels > 5) & (pixels < np.array(IMAGE_SIZE) - 6)).all(axis=1)
    ids = np.flatnonzero(inside)
    return Corners(ids, pixels[ids] + rng.normal(0, noise_px, (len(ids), 2)))


def head(distortion: tuple[float, ...]) -> StereoHead:
    rotation = Rotation.from_euler("y", 6.0, degrees=True).as_matrix()
    left, right = camera(distortion), camera(distortion)
    return StereoHead(IMAGE_SIZE, left, right, rotation, np.array([-0.12, 0.001, 0.006]), 0.0)


def head_views(
    stereo: StereoHead, rng: np.random.Generator, count: int = 24, noise_px: float = 0.05
) -> list[BoardView]:
    views: list[BoardView] = []
    while len(views) < count:
        pose = placed(rng)
        left = seen(stereo.left, pose, rng, noise_px)
        right = seen(stereo.right, stereo.right_T_left * pose, rng, noise_px)
        if min(len(left.ids), len(right.ids)) >= 44:
            views.append(BoardView(f"view {len(views) + 1}", left, right))
    return views
