"""The limits of a hand-eye calibration fit cells of any size, and find a board of a wrong one."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_limits import HandEyeLimits
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, RobotNoise, Setup
from cellctl.calibration.solvers.hand_eye.hand_eye_start import board_scale
from cellctl.geometry.uncertain import UncertainPose
from tests.rigs.calibration.hand_eye_views import NOISE, make_poses
from tests.rigs.sweeps import sweep


def scaled(pose: RigidTransform, factor: float) -> RigidTransform:
    return RigidTransform.from_components(pose.translation * factor, pose.rotation)


def of_size(poses: list[HandEyePose], factor: float) -> list[HandEyePose]:
    """The same cell, with all its lengths and their errors another size."""
    resize = np.diag([factor] * 3 + [1.0] * 3)
    return [
        HandEyePose(
            pose.name,
            scaled(pose.base_T_flange, factor),
            UncertainPose(
                scaled(pose.camera_T_board.pose, factor),
                resize @ pose.camera_T_board.covariance @ resize,
            ),
        )
        for pose in poses
    ]


def of_board(poses: list[HandEyePose], factor: float) -> list[HandEyePose]:
    """The same poses, with the squares of the board said to be so many times as large."""
    seen = [of.camera_T_board for of in poses]
    return [
        replace(pose, camera_T_board=replace(one, pose=scaled(one.pose, factor)))
        for pose, one in zip(poses, seen, strict=True)
    ]


@pytest.mark.parametrize(
    ("factor", "setup"),
    sweep(
        product((0.05, 1.0, 20.0), Setup), ((0.05, Setup.EYE_IN_HAND), (20.0, Setup.EYE_TO_HAND))
    ),
)
def test_a_good_set_passes_in_a_cell_of_any_size(factor: float, setup: Setup) -> None:
    noise = RobotNoise(NOISE.position_m * factor, NOISE.rotation_rad)
    result = calibrate_hand_eye(of_size(make_poses(3, setup), factor), setup, noise=noise)
    assert result.passed, result.checks


def test_a_robot_that_is_far_worse_than_stated_does_not_pass() -> None:
    # A cell of a twentieth the size: 0.05 mm, which is good at half a metre, is bad at 25 mm.
    stated = RobotNoise(NOISE.position_m * 0.05, NOISE.rotation_rad)
    rng = np.random.default_rng(4)
    poses = [
        replace(
            pose,
            base_T_flange=RigidTransform.from_translation(rng.normal(0.0, 5e-5, 3))
            * pose.base_T_flange,
        )
        for pose in of_size(make_poses(3, Setup.EYE_IN_HAND), 0.05)
    ]
    result = calibrate_hand_eye(poses, Setup.EYE_IN_HAND, noise=stated)
    failed = {check.name for check in result.checks if not check.passed}
    assert "residual rms" in failed
    wide = HandEyeLimits(rms_m=1e-3, rms_rad=0.01, position_sigma_m=1e-3, rotation_sigma_rad=0.01)
    assert calibrate_hand_eye(poses, Setup.EYE_IN_HAND, noise=stated, limits=wide).passed


@pytest.mark.parametrize(
    ("setup", "factor"),
    sweep(product(Setup, (0.8, 1.02, 1.25)), ((Setup.EYE_IN_HAND, 1.02), (Setup.EYE_TO_HAND, 0.8))),
)
def test_squares_of_a_wrong_size_fail_and_are_named(setup: Setup, factor: float) -> None:
    # The camera's place takes up most of a wrong distance, so little shows in the residuals.
    poses = of_board(make_poses(2, setup), factor)
    result = calibrate_hand_eye(poses, setup, noise=NOISE)
    check = next(one for one in result.checks if one.name.startswith("board's lengths"))
    assert not check.passed
    assert check.value == pytest.approx(abs(1.0 / factor - 1.0), abs=0.01)
    assert any("times as large as it was said to be" in warning for warning in result.warnings)


@pytest.mark.parametrize("setup", sweep(Setup, (Setup.EYE_IN_HAND,)))
def test_the_scale_of_the_board_is_as_sure_as_it_says(setup: Setup) -> None:
    seen = [board_scale(make_poses(seed, setup, 12), setup) for seed in range(12)]
    errors = np.array([(scale - 1.0) / sigma for scale, sigma in seen])
    # Twelve values: their mean square lies between these in all but two of a thousand cases.
    assert 0.2 < np.mean(errors**2) < 2.9
