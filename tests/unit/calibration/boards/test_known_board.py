"""A board that was measured before helps the next calibration with it, and only as far as known."""

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from cellctl.calibration.boards.board import BoardView, CalibrationBoard
from cellctl.calibration.boards.board_shape import BoardShape, shape_modes
from cellctl.calibration.boards.known_board import known_board_from_record, shape_to_adjust
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.errors.calibration import KnownBoardDiffers
from tests.rigs.calibration.stereo_views import IMAGE_SIZE, make_views
from tests.unit.calibration.solvers.stereo.test_stereo import parameter_errors

BOARD = CalibrationBoard(8, 5, 0.026)
FIRST, SECOND = 16, 9


@cache
def views() -> list[BoardView]:
    """All of one board, bent and misprinted."""
    rng = np.random.default_rng(6)
    return make_views(rng, FIRST + SECOND, board=BOARD, sag_m=8e-5, print_error_m=3e-5)


@cache
def earlier() -> StereoResult:
    return calibrate_stereo(views()[:FIRST], BOARD, IMAGE_SIZE, shape=BoardShape.PRINTED)


def record() -> dict[str, Any]:
    read: dict[str, Any] = json.loads(json.dumps(earlier().to_record()))
    return read


def normalised(result: StereoResult) -> float:
    assert result.head.covariance is not None
    off = parameter_errors(result.head)
    return float(off @ np.linalg.solve(result.head.covariance, off)) / 24


@pytest.mark.figures  # accuracy
def test_few_views_of_a_known_board_do_what_many_of_an_unknown_one_do() -> None:
    known = known_board_from_record(record())
    with_it, without = (
        calibrate_stereo(views()[FIRST:], BOARD, IMAGE_SIZE, shape=BoardShape.BENT, known=one)
        for one in (known, None)
    )
    # Bent alone does not explain the print; taken from the file, nothing is left of it but noise.
    assert with_it.sigma_px == pytest.approx(0.05, rel=0.15)
    assert without.sigma_px > 2 * with_it.sigma_px
    scatter_m = [np.abs(one.board_m - earlier().board_m).max() for one in (with_it, without)]
    assert scatter_m[0] < 0.2 * scatter_m[1]
    assert normalised(with_it) < 2.0
    covariances = [one.head.covariance for one in (with_it, without)]
    assert covariances[0] is not None
    assert covariances[1] is not None
    assert np.sqrt(np.diag(covariances[0])[21]) < 0.5 * np.sqrt(np.diag(covariances[1])[21])


def test_a_prior_is_as_wide_as_the_board_was_determined() -> None:
    known = known_board_from_record(record())
    corners_m, modes = shape_to_adjust(BOARD, BoardShape.PRINTED, known)
    plain = shape_modes(BOARD, BoardShape.PRINTED)
    np.testing.assert_allclose(corners_m, earlier().board_m, atol=1e-9)
    assert known.found is not None
    assert (modes.sigma >= known.found.sigma.clip(max=plain.sigma) - 1e-12).all()
    assert (modes.sigma <= plain.sigma).all()
    assert np.median(modes.sigma / plain.sigma) < 0.3
    # Of a board whose print was never released, only the heights are known.
    bent = replace(known.found, released=BoardShape.BENT, sigma=known.found.sigma[:12])
    _, modes = shape_to_adjust(BOARD, BoardShape.PRINTED, replace(known, found=bent))
    np.testing.assert_array_equal(modes.sigma[12:], plain.sigma[12:])
    assert (modes.sigma[:12] < plain.sigma[:12]).all()


def test_a_record_of_an_older_version_is_a_start_without_a_narrower_prior() -> None:
    old = record()
    del old["board_shape"], old["board_shape_sigma"]
    assert StereoResult.from_record(old).found_shape is None
    corners_m, modes = shape_to_adjust(BOARD, BoardShape.BENT, known_board_from_record(old))
    np.testing.assert_allclose(corners_m, earlier().board_m, atol=1e-9)
    np.testing.assert_array_equal(modes.sigma, shape_modes(BOARD, BoardShape.BENT).sigma)


@pytest.mark.parametrize(
    "other", [CalibrationBoard(8, 5, 0.025), CalibrationBoard(7, 5, 0.026)], ids=str
)
def test_another_board_is_refused(other: CalibrationBoard) -> None:
    with pytest.raises(KnownBoardDiffers, match=r"671.*known is the 8 x 5 chessboard, 26 mm"):
        shape_to_adjust(other, BoardShape.BENT, known_board_from_record(record()))


@pytest.mark.parametrize(
    "change",
    [
        {"board_corners_mm": [[0.0, 0.0, 0.0]]},
        {"board_shape": "wobbly"},
        {"board_shape_sigma": [-1.0]},
        {"board_shape_sigma": "none"},
    ],
)
def test_what_is_no_board_is_refused(change: dict[str, object]) -> None:
    with pytest.raises((TypeError, ValueError)):
        known_board_from_record({**record(), **change})
