"""Poses of which the robot and the camera tell of different turns."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.hand_eye.hand_eye_start import turns_agree
from tests.rigs.calibration.hand_eye_views import make_poses


@pytest.mark.parametrize("odd", [0, 4, 9])
def test_a_picture_of_another_pose_turns_otherwise_wherever_it_stands(odd: int) -> None:
    poses, other = make_poses(3, Setup.EYE_IN_HAND, 10), make_poses(4, Setup.EYE_IN_HAND, 10)
    seen = [pose.camera_T_board.pose for pose in poses]
    seen[odd] = other[odd].camera_T_board.pose
    agree = turns_agree([pose.base_T_flange for pose in poses], seen)
    assert np.flatnonzero(~agree).tolist() == [odd]


@pytest.mark.parametrize("count", [0, 1])
def test_one_pose_or_none_contradicts_nothing(count: int) -> None:
    poses = [RigidTransform.identity()] * count
    assert turns_agree(poses, poses).tolist() == [True] * count
