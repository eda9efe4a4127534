import json
from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest

from cellctl.calibration.boards.board import CalibrationBoard, CameraView, Corners
from cellctl.calibration.boards.projection import camera_vector
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.single_camera.single_camera_picture import single_camera_picture
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.errors.calibration import PoorCoverage, TooFewViews
from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import project, undistort
from cellctl.vision.camera.stereo_head import CameraModel
from tests.unit.calibration.solvers.single_camera.synthetic import (
    BOARD,
    CAMERA,
    DISTANCE_M,
    IMAGE_SIZE,
    camera_views,
)

SEEDS = range(6)
FEW_VIEWS = 16
"""As many as cross-validation needs: enough where one calibration is compared with another."""


@cache
def calibrated(seed: int) -> SingleCameraResult:
    return calibrate_single_camera(camera_views(np.random.default_rng(seed)), BOARD, IMAGE_SIZE)


@pytest.fixture
def results() -> list[SingleCameraResult]:
    return [calibrated(seed) for seed in SEEDS[:2]]


@pytest.fixture
def many_results() -> list[SingleCameraResult]:
    return [calibrated(seed) for seed in SEEDS]


def flat_focal_px(seed: int) -> float:
    """The focal length by OpenCV, which takes the board for flat."""
    views = camera_views(np.random.default_rng(seed))
    points = [BOARD.corners_m.astype(np.float32)] * len(views)
    pixels = [view.corners.pixels.astype(np.float32)[:, None] for view in views]
    _, matrix, *_ = cv2.calibrateCamera(points, pixels, IMAGE_SIZE, np.eye(3), np.zeros(5))
    return float(matrix[0, 0])


@pytest.mark.figures
def test_a_bow_of_micrometres_does_not_move_the_focal_length(
    many_results: list[SingleCameraResult],
) -> None:
    ours = np.array([camera_vector(one.camera.model)[0] for one in many_results]) - CAMERA[0]
    flat = np.array([flat_focal_px(seed) for seed in SEEDS]) - CAMERA[0]
    assert np.sqrt((ours**2).mean()) < 10
    assert np.sqrt((flat**2).mean()) > 2.5 * np.sqrt((ours**2).mean())


@pytest.mark.figures
def test_sigmas_are_honest(many_results: list[SingleCameraResult]) -> None:
    errors = np.array([camera_vector(one.camera.model)[:4] - CAMERA[:4] for one in many_results])
    normalised = errors / np.array([one.sigma[:4] for one in many_results])
    # Mean square of 24 normal draws, of which fx and fy are nearly the same one.
    assert 0.2 < float((normalised**2).mean()) < 2.5


def shape_errors_m(model: CameraModel) -> Array:
    """How far places on a connector of 10 mm are measured off, against each other."""
    x, y = np.meshgrid(np.linspace(-5e-3, 5e-3, 9), np.linspace(-5e-3, 5e-3, 9))
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, DISTANCE_M)], axis=1)
    pixels = project(model_of(CAMERA), points)
    found = undistort(model, pixels)[:, :2] * DISTANCE_M
    found -= found.mean(axis=0)
    # A plane is measured with a distance that a board gave: the scale is not the camera's.
    scale = float((found * points[:, :2]).sum() / (points[:, :2] ** 2).sum())
    return np.asarray(np.linalg.norm(found / scale - points[:, :2], axis=1))


def model_of(camera: Array) -> CameraModel:
    fx, fy, cx, cy = camera[:4]
    return CameraModel(np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]]), camera[4:])


@pytest.mark.figures  # accuracy
def test_a_connector_is_measured_to_a_fraction_of_a_micrometre(
    results: list[SingleCameraResult],
) -> None:
    assert max(float(shape_errors_m(one.camera.model).max()) for one in results) < 0.5e-6


def test_residuals_of_unseen_views_are_those_of_seen_ones(
    results: list[SingleCameraResult],
) -> None:
    for one in results:
        assert one.passed
        assert one.held_out_px is not None
        assert one.held_out_px < 1.1 * one.rms_px
        assert one.sigma_px == pytest.approx(0.03, rel=0.1)


def test_a_bad_view_is_named_and_left_out() -> None:
    views = camera_views(np.random.default_rng(1), FEW_VIEWS)
    moved = views[7].corners.pixels + np.random.default_rng(2).normal(0, 2.0, (88, 2))
    views[7] = CameraView("moved", Corners(views[7].corners.ids, moved))
    result = calibrate_single_camera(views, BOARD, IMAGE_SIZE)
    assert [view.name for view in result.views if not view.used] == ["moved"]
    assert any("moved" in warning for warning in result.warnings)
    assert abs(camera_vector(result.camera.model)[0] - CAMERA[0]) < 25


def test_a_picture_that_was_stored_twice_counts_once() -> None:
    views = camera_views(np.random.default_rng(1), FEW_VIEWS)
    views.append(CameraView("again", views[3].corners))
    result = calibrate_single_camera(views, BOARD, IMAGE_SIZE)
    assert [view.name for view in result.views if not view.used] == ["again"]
    assert f"left out: again: its picture is that of {views[3].name}" in result.warnings


def test_corners_in_another_order_do_not_spoil_the_start() -> None:
    views = camera_views(np.random.default_rng(1), FEW_VIEWS)
    order = np.random.default_rng(2).permutation(88)
    corners = views[7].corners
    views[7] = CameraView("mixed", Corners(corners.ids, corners.pixels[order]))
    result = calibrate_single_camera(views, BOARD, IMAGE_SIZE)
    assert [view.name for view in result.views if not view.used] == ["mixed"]
    assert abs(camera_vector(result.camera.model)[0] - CAMERA[0]) < 25


def test_few_views() -> None:
    with pytest.raises(TooFewViews, match="5 usable views"):
        calibrate_single_camera(camera_views(np.random.default_rng(0), 5), BOARD, IMAGE_SIZE)


def test_views_that_face_the_camera() -> None:
    views = camera_views(np.random.default_rng(0), 12, tilt_deg=1.0)
    with pytest.raises(PoorCoverage, match="tilt"):
        calibrate_single_camera(views, BOARD, IMAGE_SIZE)


def test_a_board_that_looks_the_same_upside_down() -> None:
    board, rng = CalibrationBoard(10, 8, 1.5e-3), np.random.default_rng(0)
    views = camera_views(rng, FEW_VIEWS, board=board)
    turned = [
        CameraView(view.name, Corners(view.corners.ids, view.corners.pixels[::-1].copy()))
        if number % 3 == 0
        else view
        for number, view in enumerate(views)
    ]
    results = [calibrate_single_camera(some, board, IMAGE_SIZE) for some in (views, turned)]
    for result in results:
        assert result.passed
        assert result.sigma_px == pytest.approx(0.03, rel=0.1)
        assert any("looks the same when it is turned" in text for text in result.warnings)
    # Whoever counts the corners from the other end gets the same camera.
    one, other = (camera_vector(result.camera.model) for result in results)
    assert np.abs((one - other)[:4]).max() < 0.01


def test_the_record_holds_everything_but_the_picture(results: list[SingleCameraResult]) -> None:
    record = json.loads(json.dumps(results[0].to_record()))
    again = SingleCameraResult.from_record(record)
    assert again.to_record() == results[0].to_record()
    assert again.camera.id == results[0].camera.id


def test_intrinsics_that_were_changed_by_hand_are_refused(
    results: list[SingleCameraResult],
) -> None:
    record = json.loads(json.dumps(results[0].to_record()))
    record["camera_matrix"][0][0] += 1.0
    with pytest.raises(ValueError, match="changed"):
        SingleCameraResult.from_record(record)


def test_the_picture_is_drawn(results: list[SingleCameraResult]) -> None:
    rejected = replace(results[0].views[0], used=False)
    shown = replace(results[0], views=(rejected, *results[0].views[1:]))
    assert single_camera_picture(shown).startswith(b"\x89PNG")


def test_the_order_of_the_images_changes_nothing(results: list[SingleCameraResult]) -> None:
    """Places in the working depth stay within a nanometre, all over the picture."""
    views = camera_views(np.random.default_rng(SEEDS[0]))
    order = np.random.default_rng(5).permutation(len(views))
    again = calibrate_single_camera([views[index] for index in order], BOARD, IMAGE_SIZE)
    x, y = np.meshgrid(*(np.linspace(20.0, side - 20.0, 5) for side in IMAGE_SIZE))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)
    places_m = [
        undistort(one.camera.model, pixels)[:, :2] * DISTANCE_M for one in (results[0], again)
    ]
    np.testing.assert_allclose(places_m[0], places_m[1], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(results[0].sigma, again.sigma, rtol=1e-6)
