"""One trial of each study of ``benchmarks.calibration.accuracy``."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.board_images import BoardImages, detect_views
from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.boards.board_shape import BoardShape
from cellctl.calibration.boards.projection import camera_vector
from cellctl.calibration.solvers.base_frame.base_frame import calibrate_base_frame
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, RobotNoise, Setup
from cellctl.calibration.solvers.hand_eye.hand_eye_start import closed_form
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_validation import intersect_rays
from cellctl.geometry.pose import pose_error
from cellctl.geometry.uncertain import UncertainPose
from cellctl.vision.camera.lens import project, undistort
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from fakes.render import api
from fakes.world.scene import LensTruth, SceneChessboard
from tests.rigs.calibration import hand_eye_views as hand_eye_case
from tests.rigs.calibration import stereo_views as synthetic
from tests.rigs.calibration import turned_arm as base_frame_case

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StereoCase:
    errors_m: tuple[float, float]
    """Rms over the working volume: absolute, and without the common offset."""
    rms_px: float
    held_out_m: float
    nees: float


@dataclass(frozen=True)
class ImageCase:
    errors_m: tuple[float, float]
    rms_px: float
    views: int
    flatness_m: float
    true_flatness_m: float


def stereo_case(
    seed: int, sag_m: float, shape: BoardShape, *, views: int = 30, hanging_px: float = 0.0
) -> StereoCase:
    """``hanging_px``: per term of an error that is smooth in each image and other in each."""
    rng = np.random.default_rng(seed)
    seen = synthetic.make_views(rng, views, sag_m=sag_m)
    if hanging_px:
        seen = synthetic.hanging_together(seen, rng, hanging_px)
    result = calibrate_stereo(seen, synthetic.BOARD, synthetic.IMAGE_SIZE, shape=shape)
    truth, head = synthetic.table_1_head(), result.head
    assert result.validation is not None
    assert head.covariance is not None
    error = np.concatenate(
        [
            camera_vector(head.left) - camera_vector(truth.left),
            camera_vector(head.right) - camera_vector(truth.right),
            Rotation.from_matrix(head.rotation @ truth.rotation.T).as_rotvec(),
            head.translation_m - truth.translation_m,
        ]
    )
    scale = np.sqrt(np.diag(head.covariance))
    scaled = head.covariance / np.outer(scale, scale)
    nees = float((error / scale) @ np.linalg.solve(scaled, error / scale))
    return StereoCase(point_errors(truth, head), head.rms_px, result.validation.held_out_m, nees)


def point_errors(truth: StereoHead, head: StereoHead) -> tuple[float, float]:
    points = synthetic.volume_points()
    left = undistort(head.left, project(truth.left, points))
    in_right = points @ truth.rotation.T + truth.translation_m
    right = undistort(head.right, project(truth.right, in_right))
    off = intersect_rays(left, right, head.rotation, head.translation_m) - points
    relative = off - off.mean(axis=0)
    return _rms(off), _rms(relative)


def image_calibration(seed: int, count: int = 24) -> ImageCase:
    """The cell's chessboard, rendered at full size, noise and texture included."""
    cv2.setNumThreads(1)
    stereo, rng = api.nominal_head(), np.random.default_rng(seed)
    bow_x, bow_y = rng.uniform(-5e-5, 5e-5, 2)
    pairs = []
    for number in range(count):
        pose = api.facing_pose(
            shift_m=(*rng.uniform(-0.03, 0.03, 2), rng.uniform(-0.01, 0.09)),
            tilt_deg=(*rng.uniform(-25, 25, 2), rng.choice([0, 180]) + rng.uniform(-25, 25)),
        )
        board = SceneChessboard(pose, (9, 6), 0.025, (0.26, 0.19), (bow_x, bow_y), seed)
        left, right = api.render_pair(stereo, [board], rng=rng)
        pairs.append(BoardImages(f"view {number}", left, right))
    pattern = CalibrationBoard(9, 6, 0.025)
    found = detect_views(pairs, pattern)
    result = calibrate_stereo(found.views, pattern, found.image_size)
    matrix = stereo.right_T_left.as_matrix()
    truth = StereoHead(
        stereo.image_size_px, _model(stereo.left), _model(stereo.right), matrix[:3, :3],
        matrix[:3, 3], 0.0,
    )  # fmt: skip
    flat = pattern.corners_m
    height = bow_x * (flat[:, 0] / 0.13) ** 2 + bow_y * (flat[:, 1] / 0.095) ** 2
    return ImageCase(
        point_errors(truth, result.head), result.head.rms_px, len(found.views),
        result.flatness_m, float(np.ptp(height)),
    )  # fmt: skip


def _model(lens: LensTruth) -> CameraModel:
    (fx, fy), (cx, cy) = lens.focal_px, lens.centre_px
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    return CameraModel(matrix, np.array(lens.distortion))


def base_frame_errors(seed: int, arc_deg: float, count: int, targets: int) -> tuple[Array, Array]:
    """Error of C_T_B, shape (6,), and its stated covariance."""
    rng = np.random.default_rng(seed)
    first, second = (
        base_frame_case.sweep(rng, joint, arc_deg, count=count, targets=targets) for joint in (0, 1)
    )
    pose = calibrate_base_frame(
        first, second, base_frame_case.ARM, noise=base_frame_case.NOISE
    ).c_T_base
    error = np.concatenate(pose_error(base_frame_case.C_T_BASE, pose.pose))
    return error, pose.covariance


def base_frame_nees(error: Array, covariance: Array) -> float:
    return float(error @ np.linalg.solve(covariance, error))


def hand_eye_errors(
    seed: int, count: int, position_mm: float, angle_deg: float
) -> tuple[Array, Array]:
    """Errors of flange_T_camera, shape (6,): closed form, maximum likelihood."""
    rng = np.random.default_rng(seed)
    noise = RobotNoise(position_mm * 1e-3, float(np.radians(angle_deg)))
    poses = []
    for number in range(count):
        seen = hand_eye_case.random_view(rng)
        flange = hand_eye_case.BASE_T_BOARD * seen.inv() * hand_eye_case.FLANGE_T_CAMERA.inv()
        pixels = project(hand_eye_case.CAMERA, seen.apply(hand_eye_case.BOARD_M))
        noisy = pixels + rng.normal(0, 0.1, pixels.shape)
        board: UncertainPose
        board, _ = board_in_camera(hand_eye_case.CAMERA, hand_eye_case.BOARD_M, noisy, 0.1)
        turn = Rotation.from_rotvec(rng.normal(0, noise.rotation_rad, 3)) * flange.rotation
        place = flange.translation + rng.normal(0, noise.position_m, 3)
        reported = RigidTransform.from_components(place, turn)
        poses.append(HandEyePose(f"pose {number}", reported, board))
    start, _, _ = closed_form(
        [pose.base_T_flange for pose in poses], [pose.camera_T_board.pose for pose in poses]
    )
    result = calibrate_hand_eye(poses, Setup.EYE_IN_HAND, noise=noise)
    truth = hand_eye_case.FLANGE_T_CAMERA
    return (
        np.concatenate(pose_error(truth, start)),
        np.concatenate(pose_error(truth, result.camera.pose)),
    )


def _rms(vectors: Array) -> float:
    return float(np.sqrt((vectors**2).sum(axis=1).mean()))
