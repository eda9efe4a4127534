"""Start values of one camera, from images of a board that is taken for flat."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CalibrationBoard, Corners
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array

_MISFIT = 5.0
"""An image does not fit when its rms is so many times the median image's, ..."""
_MISFIT_PX = 1.0
"""... and more than this: what is less is left to the adjustment, which knows the board's shape."""
_MIN_IMAGES = 4
"""Fewer images determine no camera with its lens."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraStart:
    """Where an adjustment of a camera begins."""

    camera: Array
    """Nine numbers of ``CAMERA_PARAMETERS``."""
    camera_T_board: tuple[Array, ...]
    """Of each image, 4 x 4, also of those that do not fit."""
    fits: NDArray[np.bool_]
    """False for an image that one camera cannot have taken together with the others."""


def start_of_camera(
    images: Sequence[Corners], board: CalibrationBoard, image_size: tuple[int, int]
) -> CameraStart:
    """Calibrate with the images that fit each other; raises ``SolveFailed``.

    Each camera of a head starts by itself: the joint adjustment converges only from a start near
    the solution, and wrong files show themselves in the poses of single cameras.
    """
    points = [board.corners_m[corners.ids].astype(np.float32) for corners in images]
    pixels = [corners.pixels.astype(np.float32)[:, None, :] for corners in images]
    fits = np.ones(len(images), dtype=np.bool_)
    try:
        while True:
            chosen = np.flatnonzero(fits)
            matrix, distortion, rms_px = _calibrated(points, pixels, chosen, image_size)
            worst = int(np.argmax(rms_px))
            limit_px = max(_MISFIT * float(np.median(rms_px)), _MISFIT_PX)
            if rms_px[worst] <= limit_px or len(chosen) <= _MIN_IMAGES:
                break
            # One at a time: a wrong image bends the camera so much that good ones look bad.
            fits[chosen[worst]] = False
        poses = [
            _pose(one, seen, matrix, distortion) for one, seen in zip(points, pixels, strict=True)
        ]
    except cv2.error as error:
        raise SolveFailed(f"start values of a camera: {error.err}") from error
    inner = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]]
    return CameraStart(np.concatenate([inner, distortion]), tuple(poses), fits)


def _calibrated(
    points: Sequence[NDArray[np.float32]],
    pixels: Sequence[NDArray[np.float32]],
    chosen: NDArray[np.intp],
    image_size: tuple[int, int],
) -> tuple[Array, Array, Array]:
    """Camera matrix, five distortion coefficients, rms residual of each chosen image."""
    _, matrix, distortion, _, _, _, _, rms_px = cv2.calibrateCameraExtended(
        [points[index] for index in chosen],
        [pixels[index] for index in chosen],
        image_size,
        np.eye(3),
        np.zeros(5),
    )
    coefficients = np.ravel(np.asarray(distortion, dtype=float))[:5]
    return np.asarray(matrix, dtype=float), coefficients, np.ravel(rms_px)


def _pose(
    points: NDArray[np.float32], pixels: NDArray[np.float32], matrix: Array, distortion: Array
) -> Array:
    """camera_T_board, 4 x 4."""
    # For flat boards; it also gives the better one of the two poses that a far board may have.
    _, turn, shift = cv2.solvePnP(points, pixels, matrix, distortion, flags=cv2.SOLVEPNP_IPPE)
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(np.ravel(turn)).as_matrix()
    pose[:3, 3] = np.ravel(shift)
    return pose
