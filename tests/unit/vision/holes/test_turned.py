"""A board that lies elsewhere than expected is found, and its discs get their own names."""

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board_pose import target_board_discs
from cellctl.errors.vision import HoleMissing
from cellctl.geometry.pose import MM, pose_error
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.holes.turned import pose_turned_like
from cellctl.vision.measure import measure_pair
from tests.unit.vision.plates import plate_facing, table_1_head

HEAD = table_1_head()
DISCS = [Hole(name, "disc", 20 * MM, place) for name, place in target_board_discs().items()]
TRUE = plate_facing(4.0, -6.0, 12.0)
"""Tilted by 12° about two axes, as before a head that looks at the station askew."""


def drawn(camera: CameraModel, camera_T_board: RigidTransform, discs: list[Hole]) -> Image:
    width, height = HEAD.image_size
    image = np.full((height, width), 30, np.uint8)
    angles = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
    round_ = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(200)])
    for disc in discs:
        rim = camera_T_board.apply(disc.position_m + round_ * disc.diameter_m / 2)
        # OpenCV takes sixteenths of a pixel as whole numbers.
        corners = np.rint(project(camera, rim) * 16).astype(np.int32)
        cv2.fillPoly(image, [corners], 190, cv2.LINE_AA, shift=4)
    return np.asarray(cv2.GaussianBlur(image, (0, 0), 0.9), dtype=np.uint8)


def both(discs: list[Hole]) -> HeadImages:
    left = drawn(HEAD.left, TRUE, discs)
    return HeadImages(HEAD, left, drawn(HEAD.right, HEAD.right_T_left * TRUE, discs))


IMAGES = both(DISCS)


def told(angle_deg: float) -> RigidTransform:
    """A board 50 mm off, square to the head and turned by so much about its normal."""
    about_normal = Rotation.from_euler("z", angle_deg, degrees=True)
    return plate_facing(50.0, 0.0) * RigidTransform.from_rotation(about_normal)


@pytest.mark.parametrize("angle_deg", [0.0, 60.0, -60.0])
def test_the_turn_that_is_told_decides_which_disc_is_which(angle_deg: float) -> None:
    with pytest.raises(HoleMissing):
        measure_pair(
            IMAGES.left, IMAGES.right, HEAD, DISCS,
            camera_T_part=told(angle_deg), search_radius_m=35 * MM,
        )  # fmt: skip
    distance_m, turn_rad = pose_error(TRUE, pose_turned_like(IMAGES, DISCS, told(angle_deg)))
    assert np.linalg.norm(distance_m) < 1 * MM
    assert np.degrees(np.linalg.norm(turn_rad)) < 1.0


def test_told_the_other_way_round_the_board_is_taken_so() -> None:
    found = pose_turned_like(IMAGES, DISCS, told(180.0))
    half_turn = RigidTransform.from_rotation(Rotation.from_euler("z", 180, degrees=True))
    distance_m, _ = pose_error(TRUE * half_turn, found)
    assert np.linalg.norm(distance_m) < 1 * MM


def test_a_board_with_a_covered_disc_is_not_found() -> None:
    with pytest.raises(HoleMissing):
        pose_turned_like(both(DISCS[1:]), DISCS, told(0.0))
