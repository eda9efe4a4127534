"""The shape of the board gets the freedom that the data ask for."""

from functools import cache

import numpy as np
import pytest

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.board_shape import BoardShape, shape_modes
from cellctl.calibration.solvers.shape_choice import with_chosen_shape
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from tests.rigs.calibration.stereo_views import IMAGE_SIZE, make_views
from tests.unit.calibration.solvers.stereo.test_stereo import parameter_errors

SMALL = CalibrationBoard(8, 6, 0.026)
"""Few corners, since each is two unknowns here."""


@cache
def chosen(print_error_m: float, count: int = 14) -> StereoResult:
    rng = np.random.default_rng(6)
    views = make_views(rng, count, board=SMALL, sag_m=5e-5, print_error_m=print_error_m)
    return with_chosen_shape(
        lambda shape: calibrate_stereo(views, SMALL, IMAGE_SIZE, shape=shape),
        lambda result: result.held_out_m,
    )


def test_a_print_that_is_as_drawn_stays_so() -> None:
    assert "board shape bent" in chosen(0.0).method
    assert "held-out error" in chosen(0.0).method


def test_a_print_whose_corners_are_off_is_released() -> None:
    result = chosen(2e-5)
    assert "board shape printed" in result.method
    assert result.passed
    assert result.sigma_px == pytest.approx(0.05, rel=0.1)
    # In standard deviations; with corners taken for those of the drawing the noise is three times
    # as high and the covariance with it.
    assert result.head.covariance is not None
    normalised = parameter_errors(result.head) / np.sqrt(np.diag(result.head.covariance))
    assert float(np.sqrt((normalised**2).mean())) < 2.0


def test_too_few_views_to_hold_any_back() -> None:
    assert "too few views to try another" in chosen(2e-5, 9).method


def test_modes_of_a_print_are_no_motion_and_no_scale() -> None:
    modes = shape_modes(SMALL, BoardShape.PRINTED)
    flat = SMALL.corners_m
    in_plane = modes.modes[:, :2, -(2 * len(flat) - 4) :]
    x, y = flat[:, :2].T
    for field in (np.stack([x, y], 1), np.stack([-y, x], 1), np.ones((len(flat), 2))):
        assert np.abs(np.einsum("nk,nkm->m", field, in_plane)).max() < 1e-12
