"""The target board as both cameras of a head see it: bright discs on a dark board."""

from collections.abc import Sequence

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.features.hole import Hole


def drawn_discs(
    head: StereoHead, head_T_board: RigidTransform, discs: Sequence[Hole]
) -> tuple[Image, Image]:
    """Left and right image."""
    return (
        _drawn(head.left, head.image_size, head_T_board, discs),
        _drawn(head.right, head.image_size, head.right_T_left * head_T_board, discs),
    )


def _drawn(
    camera: CameraModel,
    image_size: tuple[int, int],
    camera_T_board: RigidTransform,
    discs: Sequence[Hole],
) -> Image:
    width, height = image_size
    image = np.full((height, width), 30, np.uint8)
    angles = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
    round_ = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(200)])
    for disc in discs:
        rim = camera_T_board.apply(disc.position_m + round_ * disc.diameter_m / 2)
        # OpenCV takes sixteenths of a pixel as whole numbers.
        corners = np.rint(project(camera, rim) * 16).astype(np.int32)
        cv2.fillPoly(image, [corners], 190, cv2.LINE_AA, shift=4)
    return np.asarray(cv2.GaussianBlur(image, (0, 0), 0.9), dtype=np.uint8)
