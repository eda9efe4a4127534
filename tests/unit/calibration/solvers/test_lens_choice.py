"""A lens gets as many terms as views that were held out ask for."""

import json
from functools import cache

import numpy as np
import pytest

from cellctl.calibration.boards.lens_model import LensModel
from cellctl.calibration.solvers.lens_choice import chosen_lens
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import undistort
from cellctl.vision.camera.stereo_head import CameraModel
from tests.rigs.calibration import wide_lens
from tests.rigs.sweeps import sweep

LONG = pytest.mark.long
LENSES = {
    LensModel.FIVE: wide_lens.FIVE,
    LensModel.RATIONAL: wide_lens.RATIONAL,
    LensModel.TILTED: wide_lens.TILTED,
}


@cache
def of_camera(truth: LensModel, lens: LensModel) -> SingleCameraResult:
    model = wide_lens.camera(LENSES[truth])
    views = wide_lens.camera_views(model, np.random.default_rng(3))
    return calibrate_single_camera(views, wide_lens.BOARD, wide_lens.IMAGE_SIZE, lens=lens)


@cache
def of_head(truth: LensModel, lens: LensModel) -> StereoResult:
    views = wide_lens.head_views(wide_lens.head(LENSES[truth]), np.random.default_rng(3))
    return calibrate_stereo(views, wide_lens.BOARD, wide_lens.IMAGE_SIZE, lens=lens)


def ray_errors(found: CameraModel, truth: LensModel) -> Array:
    """How far the directions of pixels are off, up to a turn of the camera."""
    x, y = np.meshgrid(np.linspace(180, 1100, 12), np.linspace(120, 900, 10))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)
    rays = []
    for model in (found, wide_lens.camera(LENSES[truth])):
        flat = np.column_stack([undistort(model, pixels), np.ones(len(pixels))])
        rays.append(flat / np.linalg.norm(flat, axis=1)[:, None])
    u, _, vt = np.linalg.svd(rays[0].T @ rays[1])
    return np.asarray(np.linalg.norm(rays[0] @ (u @ vt) - rays[1], axis=1))


@pytest.mark.parametrize(
    "truth",
    [
        LensModel.FIVE,
        pytest.param(LensModel.TILTED, marks=pytest.mark.figures),
        pytest.param(LensModel.RATIONAL, marks=LONG),
    ],
)
def test_a_camera_gets_the_terms_of_its_lens(truth: LensModel) -> None:
    lens, why = chosen_lens(lambda lens: of_camera(truth, lens), lambda one: one.held_out_px)
    assert lens is truth
    for tried in ("8 terms", "12 terms", "14 terms"):
        assert tried in why
    result = of_camera(truth, lens)
    assert f"lens of {lens.terms} terms" in result.method
    assert result.passed, result.checks
    assert result.sigma_px == pytest.approx(0.05, rel=0.1)
    assert np.sqrt((ray_errors(result.camera.model, truth) ** 2).mean()) < 1e-4


@pytest.mark.parametrize(
    "truth", sweep((LensModel.RATIONAL, LensModel.TILTED), (LensModel.RATIONAL,))
)
def test_five_terms_would_leave_more(truth: LensModel) -> None:
    five, right = of_camera(truth, LensModel.FIVE), of_camera(truth, truth)
    assert five.held_out_px is not None
    assert right.held_out_px is not None
    assert right.held_out_px < 0.9 * five.held_out_px
    errors = [np.sqrt((ray_errors(one.camera.model, truth) ** 2).mean()) for one in (five, right)]
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.figures
def test_a_head_gets_the_terms_of_its_lenses() -> None:
    """Each of the four models is solved."""
    truth = LensModel.RATIONAL
    assert chosen_lens(lambda lens: of_head(truth, lens), lambda one: one.held_out_m)[0] is truth


@pytest.mark.long
def test_a_head_gets_no_terms_that_its_lenses_do_not_need() -> None:
    truth = LensModel.FIVE
    assert chosen_lens(lambda lens: of_head(truth, lens), lambda one: one.held_out_m)[0] is truth


@pytest.mark.figures  # accuracy
def test_a_head_with_the_terms_of_its_lenses_is_as_it_was_drawn() -> None:
    lens = LensModel.RATIONAL
    result = of_head(lens, lens)
    off_m = result.head.translation_m - wide_lens.head(LENSES[lens]).translation_m
    covariance = result.head.covariance
    assert covariance is not None
    assert covariance.shape == (14 + 2 * lens.terms,) * 2
    assert np.abs(off_m / np.sqrt(np.diag(covariance)[-3:])).max() < 4.0


def test_records_hold_all_terms() -> None:
    camera, head = (
        of_camera(LensModel.TILTED, LensModel.TILTED),
        of_head(LensModel.RATIONAL, LensModel.RATIONAL),
    )
    again = SingleCameraResult.from_record(json.loads(json.dumps(camera.to_record())))
    assert again.to_record() == camera.to_record()
    assert len(again.camera.model.distortion) == 14
    assert again.camera.id == camera.camera.id
    record = json.loads(json.dumps(head.to_record()))
    assert record["covariance_order"][12:14] == ["right.fx", "right.fy"]
    read = StereoResult.from_record(record)
    assert read.to_record()["left"] == head.to_record()["left"]
    assert read.head.covariance is not None
    assert head.head.covariance is not None
    np.testing.assert_allclose(read.head.covariance, head.head.covariance, rtol=1e-12)


def test_a_model_without_a_solution_is_not_taken() -> None:
    def calibrate(lens: LensModel) -> SingleCameraResult:
        if lens is LensModel.TILTED:
            raise SolveFailed("singular")
        return of_camera(LensModel.RATIONAL, lens)

    lens, why = chosen_lens(calibrate, lambda one: one.held_out_px)
    assert lens is LensModel.RATIONAL
    assert "14 terms have no solution" in why


def test_too_few_views_to_choose() -> None:
    five = of_camera(LensModel.FIVE, LensModel.FIVE)
    assert chosen_lens(lambda _: five, lambda _: None)[0] is LensModel.FIVE
