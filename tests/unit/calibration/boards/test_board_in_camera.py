"""The pose of a board in a camera, and what its corners do not determine."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.errors.calibration import BoardPoseInvalid
from cellctl.geometry.pose import Array, pose_error
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel

CAMERA = CameraModel(
    np.array([[3000.0, 0.0, 1000.0], [0.0, 3000.0, 800.0], [0.0, 0.0, 1.0]]), np.zeros(5)
)
CAMERA_T_BOARD = RigidTransform.from_components(
    [0.01, 0.02, 0.5], Rotation.from_rotvec([0.2, -0.3, 0.1])
)
GRID = np.array([[0.01 * column, 0.01 * row, 0.0] for row in range(2) for column in range(6)])


def seen(points_m: Array) -> Array:
    return project(CAMERA, np.asarray(CAMERA_T_BOARD.apply(points_m)))


def test_two_rows_of_corners_have_a_pose() -> None:
    found, rms_px = board_in_camera(CAMERA, GRID, seen(GRID), sigma_px=0.1)
    assert np.abs(np.concatenate(pose_error(CAMERA_T_BOARD, found.pose))).max() < 1e-8
    assert rms_px < 1e-6


@pytest.mark.parametrize(
    "points_m",
    [GRID[:6], GRID[:6] @ [[1, 1, 0], [0, 0, 0], [0, 0, 0]], np.zeros((8, 3))],
    ids=["a row", "a diagonal", "one place"],
)
def test_corners_on_a_line_do_not_say_how_the_board_is_turned_about_it(points_m: Array) -> None:
    with pytest.raises(BoardPoseInvalid, match="on a line"):
        board_in_camera(CAMERA, points_m, seen(points_m), sigma_px=0.1)
