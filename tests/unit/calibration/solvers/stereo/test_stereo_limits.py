"""Limits that follow the geometry, and what is known of a head without a board."""

from functools import cache

import numpy as np
import pytest

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_limits import KnownGeometry, StereoLimits
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from tests.rigs.calibration.stereo_views import BOARD, IMAGE_SIZE, make_views
from tests.rigs.sweeps import sweep


@cache
def calibrated(scale: float, noise_px: float = 0.05) -> StereoResult:
    """A head and a board that are larger by ``scale``: their images are the same."""
    views = make_views(np.random.default_rng(5), 14, noise_px=noise_px)
    board = CalibrationBoard(BOARD.columns, BOARD.rows, BOARD.square_m * scale)
    return calibrate_stereo(views, board, IMAGE_SIZE)


def failed(result: StereoResult) -> list[str]:
    return [check.name for check in result.checks if not check.passed]


@pytest.mark.parametrize("scale", sweep((0.1, 1.0, 6.0), (6.0,)))
def test_a_good_set_passes_whatever_the_size_of_the_head(scale: float) -> None:
    assert calibrated(scale).passed, failed(calibrated(scale))


@pytest.mark.parametrize("scale", sweep((0.1, 6.0), (0.1,)))
def test_corners_that_are_too_rough_fail_whatever_the_size_of_the_head(scale: float) -> None:
    assert "held-out error" in failed(calibrated(scale, 0.15))


def test_a_limit_that_the_user_states_counts() -> None:
    result = calibrated(1.0)
    assert result.validation is not None
    limits = StereoLimits(held_out_m=1e-6)
    checks = limits.checks(result.head, np.array([0.5]), 0.0, result.validation.held_out_m)
    assert [check.name for check in checks if not check.passed] == ["held-out error"]


@pytest.mark.parametrize(
    ("known", "wrong"),
    [
        (KnownGeometry(baseline_m=0.179, focal_px=3580.0, distance_m=0.5), []),
        (KnownGeometry(baseline_m=0.215), ["baseline against the stated one"]),
        (KnownGeometry(distance_m=0.4), ["distance of the board against the stated one"]),
        (KnownGeometry(focal_px=2400.0), ["focal length against the stated one"]),
    ],
)
def test_what_is_known_is_compared(known: KnownGeometry, wrong: list[str]) -> None:
    checks = known.checks(calibrated(1.0).head, np.array([0.48, 0.5, 0.51]))
    assert [check.name for check in checks if not check.passed] == wrong


def test_the_focal_length_says_nothing_of_the_scale() -> None:
    assert not KnownGeometry(focal_px=3580.0).tells_scale
    assert KnownGeometry(distance_m=0.5).tells_scale
