"""Start values of one camera, from images of a board that is taken for flat."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CalibrationBoard, Circles, Corners
from cellctl.calibration.boards.corners.circle_centres import centre_offsets
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array

_MISFIT = 5.0
"""An image does not fit when its rms is so many times the median image's, ..."""
_MISFIT_PX = 1.0
"""... and more than this: what is less is left to the adjustment, which knows the board's shape."""
_ROUNDS_OF_CIRCLES = 2
_MIN_IMAGES = 4
"""Fewer images determine no camera with its lens."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraStart:
    """The values at which the adjustment of a camera begins."""

    camera: Array
    """Nine numbers of ``CAMERA_PARAMETERS``."""
    camera_T_board: tuple[Array, ...]
    """Pose of the board in each image, 4 x 4, also in images that do not fit."""
    fits: NDArray[np.bool_]
    """False for an image that one camera cannot have taken together with the others."""
    images: tuple[Corners, ...]
    """What was seen; on a circle grid with the images of the centres in place of the centres of
    the images."""

    def with_terms(self, terms: int) -> Array:
        """The camera with the distortion that an adjustment begins with, shape (4 + terms,)."""
        return np.concatenate([self.camera, np.zeros(terms - 5)])


def start_of_camera(
    images: Sequence[Corners], board: CalibrationBoard, image_size: tuple[int, int]
) -> CameraStart:
    """Calibrate with the images that fit each other; raises ``SolveFailed``.

    Each camera of a head starts by itself: the joint adjustment converges only from a start near
    the solution, and wrong files show themselves in the poses of single cameras.
    """
    start = _start(images, board, image_size)
    if board.circles is None:
        return start
    # Offsets of some hundredths of a pixel depend on camera and poses, and these a little on the
    # offsets. After two rounds they change by less than a thousandth of a pixel, and a better lens
    # or the bow of the board does not change them by more either.
    for _ in range(_ROUNDS_OF_CIRCLES):
        start = _start(_centred(images, board, board.circles, start), board, image_size)
    return start


def _start(
    images: Sequence[Corners], board: CalibrationBoard, image_size: tuple[int, int]
) -> CameraStart:
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
    return CameraStart(np.concatenate([inner, distortion]), tuple(poses), fits, tuple(images))


def _centred(
    images: Sequence[Corners], board: CalibrationBoard, circles: Circles, start: CameraStart
) -> list[Corners]:
    """Where the centres of the circles are seen, computed from the centres of their ellipses."""
    centred = []
    for corners, pose in zip(images, start.camera_T_board, strict=True):
        offsets = centre_offsets(
            start.camera,
            pose[:3, :3],
            pose[:3, 3],
            board.corners_m[corners.ids],
            circles.diameter_m / 2,
        )
        centred.append(Corners(corners.ids, corners.pixels - offsets))
    return centred


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
