"""Mistakes in the files of a hand-eye calibration are named."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_mistakes import explanation
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, Setup
from cellctl.errors.calibration import PosesNotDiverse, RobotCameraMismatch
from cellctl.geometry.pose import pose_from_xyzabc, pose_to_xyzabc
from tests.rigs.calibration.hand_eye_views import make_poses
from tests.rigs.sweeps import sweep

Change = Callable[[RigidTransform], RigidTransform]


def metres_for_mm(pose: RigidTransform) -> RigidTransform:
    return RigidTransform.from_components(pose.translation / 1e3, pose.rotation)


def radians_for_degrees(pose: RigidTransform) -> RigidTransform:
    written = pose_to_xyzabc(pose)
    return pose_from_xyzabc([*written[:3], *np.radians(written[3:])])


def inverted(pose: RigidTransform) -> RigidTransform:
    return pose.inv()


def changed(
    poses: list[HandEyePose], flange: Change | None = None, board: Change | None = None
) -> list[HandEyePose]:
    if flange is not None:
        poses = [replace(pose, base_T_flange=flange(pose.base_T_flange)) for pose in poses]
    if board is not None:
        poses = [
            replace(
                pose,
                camera_T_board=replace(pose.camera_T_board, pose=board(pose.camera_T_board.pose)),
            )
            for pose in poses
        ]
    return poses


@pytest.mark.parametrize("setup", sweep(Setup, (Setup.EYE_IN_HAND,)))
@pytest.mark.parametrize(
    ("flange", "board", "words"),
    [
        (inverted, None, r"the data fit eye-\w+-hand, or the poses of the robot are inverted"),
        (None, inverted, "the poses of the board are inverted"),
        (metres_for_mm, None, "the robot's lengths are in metres"),
        (None, metres_for_mm, "the board's lengths are in metres"),
        (radians_for_degrees, None, "the robot's angles are in radians"),
        (None, radians_for_degrees, "the board's angles are in radians"),
    ],
)
def test_a_mistake_in_the_whole_file_is_named(
    setup: Setup, flange: Change | None, board: Change | None, words: str
) -> None:
    poses = changed(make_poses(2, setup, 14), flange, board)
    with pytest.raises(RobotCameraMismatch, match=words):
        calibrate_hand_eye(poses, setup)


@pytest.mark.parametrize(
    ("setup", "words"),
    [
        (Setup.EYE_IN_HAND, "the camera is 110 mm from the flange and the board 1517 mm"),
        (Setup.EYE_TO_HAND, "the board is 110 mm from the flange and the camera 1517 mm"),
    ],
)
def test_poses_that_are_all_inverted_are_named(setup: Setup, words: str) -> None:
    poses = make_poses(2, setup, 14)
    result = calibrate_hand_eye(changed(poses, inverted, inverted), setup)
    assert not result.passed
    assert words in result.warnings[0]
    right = calibrate_hand_eye(poses, setup)
    assert right.checks[-1].passed
    assert not any("inverted" in warning for warning in right.warnings)


def test_poses_of_another_day_are_explained_by_nothing() -> None:
    poses, others = make_poses(0, Setup.EYE_IN_HAND, 14), make_poses(1, Setup.EYE_IN_HAND, 14)
    mixed = [
        replace(pose, camera_T_board=other.camera_T_board)
        for pose, other in zip(poses, others, strict=True)
    ]
    assert explanation(mixed, Setup.EYE_IN_HAND) is None
    with pytest.raises(RobotCameraMismatch):
        calibrate_hand_eye(mixed, Setup.EYE_IN_HAND)


def test_two_pictures_that_were_exchanged() -> None:
    poses = make_poses(3, Setup.EYE_IN_HAND, 14)
    seen = [pose.camera_T_board for pose in poses]
    poses[4], poses[9] = (
        replace(poses[4], camera_T_board=seen[9]),
        replace(poses[9], camera_T_board=seen[4]),
    )
    result = calibrate_hand_eye(poses, Setup.EYE_IN_HAND)
    assert set(result.rejected) == {"pose 4", "pose 9"}
    assert "pose 4 and pose 9 fit with their pictures exchanged" in result.warnings


def test_a_board_that_was_taken_for_turned() -> None:
    poses = make_poses(3, Setup.EYE_IN_HAND, 14)
    # About its middle: the origin of this board lies there.
    turned = RigidTransform.from_rotation(Rotation.from_euler("z", 180, degrees=True))
    seen = poses[6].camera_T_board
    poses[6] = replace(poses[6], camera_T_board=replace(seen, pose=seen.pose * turned))
    result = calibrate_hand_eye(poses, Setup.EYE_IN_HAND)
    assert result.rejected == ("pose 6",)
    assert "in pose 6 the board was taken for turned by 180°" in result.warnings


def test_radians_in_both_fit_each_other_and_are_asked_about() -> None:
    poses = changed(
        make_poses(0, Setup.EYE_IN_HAND), radians_for_degrees, board=radians_for_degrees
    )
    with pytest.raises(PosesNotDiverse, match="robot and board written in radians"):
        calibrate_hand_eye(poses, Setup.EYE_IN_HAND)
