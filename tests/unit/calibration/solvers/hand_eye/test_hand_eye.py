import json
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation
from scipy.stats import chi2

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_picture import hand_eye_picture
from cellctl.calibration.solvers.hand_eye.hand_eye_result import (
    HandEyePose,
    HandEyeResult,
    Setup,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_start import closed_form
from cellctl.errors.calibration import BoardPoseInvalid, PosesNotDiverse, RobotCameraMismatch
from cellctl.geometry.pose import pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.vision.camera.lens import project
from tests.rigs.calibration.hand_eye_views import (
    BASE_T_BOARD,
    BASE_T_CAMERA,
    BOARD_M,
    CAMERA,
    FLANGE_T_BOARD,
    FLANGE_T_CAMERA,
    NOISE,
    make_poses,
    random_view,
    small,
)

Array = NDArray[np.float64]
FEW_AND_ALL = pytest.mark.parametrize("seeds", [3, pytest.param(6, marks=pytest.mark.long)])


def errors(result: HandEyeResult) -> Array:
    return np.concatenate(pose_error(FLANGE_T_CAMERA, result.camera.pose))


@cache
def in_hand(seed: int) -> HandEyeResult:
    poses = make_poses(seed, Setup.EYE_IN_HAND)
    return calibrate_hand_eye(poses, Setup.EYE_IN_HAND, noise=NOISE)


def rms(values: Array) -> tuple[float, float]:
    """3-D rms: metres, radians."""
    squares = (values**2).mean(axis=0)
    return float(np.sqrt(squares[:3].sum())), float(np.sqrt(squares[3:].sum()))


@FEW_AND_ALL
def test_accuracy_against_the_closed_form(seeds: int) -> None:
    results = [in_hand(seed) for seed in range(seeds)]
    position_m, rotation_rad = rms(np.stack([errors(result) for result in results]))
    assert position_m < 8.5e-5
    assert np.degrees(rotation_rad) < 0.01
    closed = []
    for seed in range(seeds):
        poses = make_poses(seed, Setup.EYE_IN_HAND)
        x, _, _ = closed_form(
            [pose.base_T_flange for pose in poses], [pose.camera_T_board.pose for pose in poses]
        )
        closed.append(np.concatenate(pose_error(FLANGE_T_CAMERA, x)))
    assert position_m < rms(np.stack(closed))[0]


@FEW_AND_ALL
def test_covariance_is_honest(seeds: int) -> None:
    results = [in_hand(seed) for seed in range(seeds)]
    total = sum(
        float(errors(result) @ np.linalg.solve(result.camera.covariance, errors(result)))
        for result in results
    )
    band = chi2(6 * len(results)).interval(0.999)
    assert 0.7 * band[0] < total < band[1]
    assert all(result.passed and not result.warnings for result in results)


@pytest.mark.parametrize("seeds", [1, pytest.param(3, marks=pytest.mark.long)])
def test_eye_to_hand(seeds: int) -> None:
    results = [
        calibrate_hand_eye(make_poses(seed, Setup.EYE_TO_HAND), Setup.EYE_TO_HAND, noise=NOISE)
        for seed in range(seeds)
    ]
    for result in results:
        camera = np.concatenate(pose_error(BASE_T_CAMERA, result.camera.pose))
        assert np.abs(camera[:3]).max() < 3e-4
        board = np.concatenate(pose_error(FLANGE_T_BOARD, result.board.pose))
        assert np.degrees(np.abs(board[3:]).max()) < 0.03
        assert result.chi2_ratio == pytest.approx(1, abs=0.5)


def test_wrong_setup_is_told_from_the_right_one() -> None:
    poses = make_poses(0, Setup.EYE_TO_HAND)
    with pytest.raises(RobotCameraMismatch, match="the data fit eye-to-hand"):
        calibrate_hand_eye(poses, Setup.EYE_IN_HAND)


def test_wrong_angle_convention() -> None:
    poses = [
        HandEyePose(
            pose.name,
            RigidTransform.from_components(
                pose.base_T_flange.translation,
                Rotation.from_euler("xyz", pose.base_T_flange.rotation.as_euler("ZYX")),
            ),
            pose.camera_T_board,
        )
        for pose in make_poses(0, Setup.EYE_IN_HAND)
    ]
    with pytest.raises(RobotCameraMismatch, match="off by"):
        calibrate_hand_eye(poses, Setup.EYE_IN_HAND)


def test_gross_error_is_named_and_left_out() -> None:
    poses = make_poses(0, Setup.EYE_IN_HAND)
    wrong = poses[4].base_T_flange * small(np.random.default_rng(9), 2e-3, 2e-3)
    poses[4] = HandEyePose(poses[4].name, wrong, poses[4].camera_T_board)
    result = calibrate_hand_eye(poses, Setup.EYE_IN_HAND, noise=NOISE)
    assert result.rejected == ("pose 4",)
    assert any("pose 4" in warning for warning in result.warnings)
    assert np.abs(errors(result)[:3]).max() < 3e-4


def test_poses_must_differ() -> None:
    poses = make_poses(0, Setup.EYE_IN_HAND)
    with pytest.raises(PosesNotDiverse, match="3 poses"):
        calibrate_hand_eye(poses[:3], Setup.EYE_IN_HAND)
    with pytest.raises(PosesNotDiverse, match="turn by 3°"):
        calibrate_hand_eye([poses[0]] * 8, Setup.EYE_IN_HAND)
    about_z = []
    for angle in np.linspace(-40, 40, 10):
        turn = pose_from_xyzabc([0, 0, 0, angle, 0, 0])
        base_T_flange = turn * poses[0].base_T_flange
        seen = FLANGE_T_CAMERA.inv() * base_T_flange.inv() * BASE_T_BOARD
        exact = UncertainPose(seen, poses[0].camera_T_board.covariance)
        about_z.append(HandEyePose(f"{angle:.0f}°", base_T_flange, exact))
    with pytest.raises(PosesNotDiverse, match="one direction only"):
        calibrate_hand_eye(about_z, Setup.EYE_IN_HAND)


def test_record_and_picture() -> None:
    result = in_hand(0)
    again = HandEyeResult.from_record(json.loads(json.dumps(result.to_record())))
    np.testing.assert_allclose(
        again.camera.pose.as_matrix(), result.camera.pose.as_matrix(), atol=1e-12
    )
    assert again.setup is result.setup
    assert again.checks == result.checks
    assert hand_eye_picture(again).startswith(b"\x89PNG")


def test_pnp_covariance_matches_its_scatter() -> None:
    rng = np.random.default_rng(1)
    truth = random_view(rng)
    clean = project(CAMERA, truth.apply(BOARD_M))
    total = 0.0
    for _ in range(100):
        pose, residual = board_in_camera(CAMERA, BOARD_M, clean + rng.normal(0, 0.2, clean.shape))
        error = np.concatenate(pose_error(truth, pose.pose))
        total += float(error @ np.linalg.solve(pose.covariance, error))
        assert residual == pytest.approx(0.2 * np.sqrt(2), rel=0.3)
    band = chi2(600).interval(0.999)
    assert band[0] < total < band[1] * 1.02  # the noise is estimated, so the tail is a bit longer
    with pytest.raises(BoardPoseInvalid):
        board_in_camera(CAMERA, BOARD_M[:5], clean[:5])


@pytest.mark.parametrize("setup", list(Setup))
def test_the_order_of_the_poses_changes_nothing(setup: Setup) -> None:
    poses = make_poses(4, setup)
    # One pose is wrong, so that what is left out does not depend on the order either.
    wrong = perturbed_by_mm(poses[7], 4.0)
    poses = [*poses[:7], wrong, *poses[8:]]
    found = calibrate_hand_eye(poses, setup, noise=NOISE)
    assert found.rejected == ("pose 7",)
    order = np.random.default_rng(0).permutation(len(poses))
    again = calibrate_hand_eye([poses[index] for index in order], setup, noise=NOISE)
    assert again.rejected == found.rejected
    for one, other in ((found.camera, again.camera), (found.board, again.board)):
        off_m, off_rad = pose_error(one.pose, other.pose)
        assert np.linalg.norm(off_m) < 1e-9
        assert np.linalg.norm(off_rad) < 1e-9


def perturbed_by_mm(pose: HandEyePose, off_mm: float) -> HandEyePose:
    """The same pose of the arm with the board seen beside its place."""
    beside = RigidTransform.from_translation([off_mm * 1e-3, 0.0, 0.0])
    seen = UncertainPose(beside * pose.camera_T_board.pose, pose.camera_T_board.covariance)
    return HandEyePose(pose.name, pose.base_T_flange, seen)
