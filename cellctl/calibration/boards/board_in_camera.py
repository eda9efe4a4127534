"""Pose of a board in a camera from its corners, with the covariance that the corners leave."""

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.projection import camera_vector, project
from cellctl.errors.calibration import BoardPoseInvalid
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose, perturbed, skews
from cellctl.vision.camera.stereo_head import CameraModel

_MIN_CORNERS = 6
"""Four give a pose, but nothing that would show how good it is."""
_LEAST_SPREAD = 0.01
"""Width of the corners over their length, both rms. Corners on a line leave the turn about it open;
those of any board that is in use spread ten times as far."""


def board_in_camera(
    camera: CameraModel, board_m: Array, pixels: Array, sigma_px: float | None = None
) -> tuple[UncertainPose, float]:
    """camera_T_board and the rms residual (px, both axes) from points (n, 3) and pixels (n, 2).

    Without ``sigma_px`` the noise is estimated from the residuals. Raises ``BoardPoseInvalid`` for
    fewer than six corners and for corners on a line.
    """
    if len(board_m) < _MIN_CORNERS or len(board_m) != len(pixels):
        raise BoardPoseInvalid(f"{len(pixels)} corners for {len(board_m)} points")
    length, width, _ = np.linalg.svd(board_m - board_m.mean(axis=0), compute_uv=False)
    # Refused before solving: the solver makes up a turn about the line, and its normal matrix is
    # singular only within rounding, so that the covariance would call that turn certain.
    if not width > _LEAST_SPREAD * length:
        raise BoardPoseInvalid(f"the {len(board_m)} corners lie on a line")
    is_found, turn, shift = cv2.solvePnP(board_m, pixels, camera.camera_matrix, camera.distortion)
    if not is_found:
        raise BoardPoseInvalid("the corners give no pose")
    pose = RigidTransform.from_components(np.ravel(shift), Rotation.from_rotvec(np.ravel(turn)))
    # OpenCV's solution has no covariance: a few Gauss-Newton steps from it give both.
    vector = camera_vector(camera)
    for _ in range(10):
        turned = pose.rotation.apply(board_m)
        projection = project(vector, turned + pose.translation)
        residuals = (pixels - projection.pixels).ravel()
        by_turn = -projection.by_point @ skews(turned)
        jacobian = np.concatenate([projection.by_point, by_turn], axis=2).reshape(-1, 6)
        delta = np.linalg.lstsq(jacobian, residuals, rcond=None)[0]
        pose = perturbed(pose, delta)
        if np.abs(delta).max() < 1e-12:
            break
    squares = float(residuals @ residuals)
    if sigma_px is None:
        sigma_px = float(np.sqrt(squares / max(len(residuals) - 6, 1)))
    # The Jacobian of the last step: the pose moves by less than rounding after it.
    covariance = np.linalg.inv(jacobian.T @ jacobian) * sigma_px**2
    return UncertainPose(pose, covariance), float(np.sqrt(squares / len(board_m)))
