"""Weights that were stated wrongly do not make the solution worse than one without weights."""

from dataclasses import replace

import numpy as np

from benchmarks.calibration.hand_eye_comparison import errors_of, median, worse
from benchmarks.calibration.hand_eye_sets import KINDS, daniilidis, drawn_set, park
from cellctl.calibration.solvers.hand_eye.hand_eye_adjustment import adjust_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.hand_eye.hand_eye_start import closed_form
from cellctl.geometry.pose import pose_error
from tests.rigs.calibration.hand_eye_views import (
    BASE_T_BOARD,
    FLANGE_T_CAMERA,
    NOISE,
    make_poses,
)


def test_scales_follow_what_the_poses_really_have() -> None:
    found = []
    for seed in range(4):
        poses = drawn_set(KINDS["robot's angles six times worse"], 20, seed)
        x, z, _ = closed_form(
            [pose.base_T_flange for pose in poses], [pose.camera_T_board.pose for pose in poses]
        )
        scales = adjust_hand_eye(poses, Setup.EYE_IN_HAND, NOISE, x, z).scales
        found.append((scales.robot_position, scales.robot_rotation, scales.camera))
    position, rotation, camera = np.median(found, axis=0)
    assert 3.0 < rotation < 12.0
    assert position < 2.5
    assert camera < 2.5


def test_wrong_proportions_are_no_worse_than_no_weights() -> None:
    errors, squared = errors_of(KINDS["robot's angles six times worse"], 8, 6)
    ours, of_park, of_daniilidis = median(errors)
    # Position and angle together: six sets alone scatter too much to hold each of them.
    assert np.prod(ours) < 0.8 * min(np.prod(of_park), np.prod(of_daniilidis))
    # 36 numbers, nearly normal: honest covariances stay below this.
    assert squared < 2.0


def test_closed_forms_to_compare_with_are_right() -> None:
    exact = [
        replace(
            pose,
            base_T_flange=BASE_T_BOARD * pose.camera_T_board.pose.inv() * FLANGE_T_CAMERA.inv(),
        )
        for pose in make_poses(5, Setup.EYE_IN_HAND, 8)
    ]
    for found in (park(exact), daniilidis(exact)):
        off_m, off_rad = pose_error(FLANGE_T_CAMERA, found)
        assert np.linalg.norm(off_m) < 1e-8
        assert np.linalg.norm(off_rad) < 1e-8


def test_the_comparison_sees_what_is_worse_and_lets_equals_pass() -> None:
    errors = np.random.default_rng(2).rayleigh(size=40)
    assert worse(1.3 * errors, errors, median)
    assert not worse(errors, errors, median)
    assert not worse(0.8 * errors, errors, median)
