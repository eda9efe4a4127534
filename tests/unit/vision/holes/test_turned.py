"""A board that lies elsewhere than expected is found, and its discs get their own names."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board_pose import target_board_discs
from cellctl.errors.vision import HoleMissing
from cellctl.geometry.pose import MM, pose_error
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.holes.turned import pose_turned_like
from cellctl.vision.measure import measure_pair
from tests.rigs.calibration.drawn_discs import drawn_discs
from tests.rigs.sweeps import sweep
from tests.unit.vision.plates import plate_facing, table_1_head

HEAD = table_1_head()
DISCS = [Hole(name, "disc", 20 * MM, place) for name, place in target_board_discs().items()]
TRUE = plate_facing(4.0, -6.0, 12.0)
"""Tilted by 12° about two axes, as before a head that looks at the station askew."""


def both(discs: list[Hole]) -> HeadImages:
    return HeadImages(HEAD, *drawn_discs(HEAD, TRUE, discs))


IMAGES = both(DISCS)


def told(angle_deg: float) -> RigidTransform:
    """A board 50 mm off, square to the head and turned by so much about its normal."""
    about_normal = Rotation.from_euler("z", angle_deg, degrees=True)
    return plate_facing(50.0, 0.0) * RigidTransform.from_rotation(about_normal)


@pytest.mark.parametrize("angle_deg", sweep((0.0, 60.0, -60.0), (60.0,)))
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
