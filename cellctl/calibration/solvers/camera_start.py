"""Start values of one camera, from images of a board that is taken for flat."""

from collections.abc import Sequence

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CalibrationBoard, Corners
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array


def start_of_camera(
    images: Sequence[Corners], board: CalibrationBoard, image_size: tuple[int, int]
) -> tuple[Array, list[Array]]:
    """Nine numbers of ``CAMERA_PARAMETERS`` and camera_T_board of each image, 4 x 4.

    Raises ``SolveFailed``.
    """
    flat = board.corners_m
    points = [flat[corners.ids].astype(np.float32) for corners in images]
    pixels = [corners.pixels.astype(np.float32)[:, None, :] for corners in images]
    try:
        _, matrix, distortion, turns, shifts = cv2.calibrateCamera(
            # Each camera by itself first: the joint adjustment converges only from a start near the
            # solution, and wrong files show themselves in the poses of single cameras.
            points,
            pixels,
            image_size,
            np.eye(3),
            np.zeros(5),
        )
    except cv2.error as error:
        raise SolveFailed(f"start values of a camera: {error.err}") from error
    poses = []
    for turn, shift in zip(turns, shifts, strict=True):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(np.ravel(turn)).as_matrix()
        pose[:3, 3] = np.ravel(shift)
        poses.append(pose)
    k = np.asarray(matrix, dtype=float)
    inner = [k[0, 0], k[1, 1], k[0, 2], k[1, 2]]
    return np.concatenate([inner, np.ravel(distortion)[:5]]), poses
