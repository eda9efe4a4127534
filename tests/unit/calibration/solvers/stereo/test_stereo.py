import json
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from cellctl.calibration.boards.board import BoardView, CalibrationBoard, Corners
from cellctl.calibration.boards.board_shape import BoardShape
from cellctl.calibration.boards.projection import camera_vector
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.calibration.solvers.stereo.stereo_validation import intersect_rays
from cellctl.errors.calibration import (
    CalibrationCamerasSwapped,
    CalibrationCameraUpsideDown,
    CameraSeenTwice,
    PairsInconsistent,
    PoorCoverage,
    TooFewViews,
)
from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import project, undistort
from cellctl.vision.camera.stereo_head import StereoHead
from tests.rigs.calibration.stereo_views import (
    BOARD,
    IMAGE_SIZE,
    hanging_together,
    make_views,
    table_1_head,
    volume_points,
)
from tests.rigs.sweeps import sweep

ONE, FEW, SEEDS = range(1), range(2), range(4)
"""A calibration of thirty views takes seconds: more than one of each kind are for the tests marked
figures, four for those marked long."""
TRUTH = table_1_head()
BOW_M = 5e-5


def errors_m(head: StereoHead) -> tuple[float, float]:
    """Rms error of points in the working volume: absolute, and without the common offset."""
    points = volume_points()
    right_points = points @ TRUTH.rotation.T + TRUTH.translation_m
    left = undistort(head.left, project(TRUTH.left, points))
    right = undistort(head.right, project(TRUTH.right, right_points))
    off = intersect_rays(left, right, head.rotation, head.translation_m) - points
    relative = off - off.mean(axis=0)
    return tuple(float(np.sqrt((e**2).sum(axis=1).mean())) for e in (off, relative))  # type: ignore[return-value]


def parameter_errors(head: StereoHead) -> Array:
    turn = Rotation.from_matrix(head.rotation @ TRUTH.rotation.T).as_rotvec()
    left = camera_vector(head.left) - camera_vector(TRUTH.left)
    right = camera_vector(head.right) - camera_vector(TRUTH.right)
    return np.concatenate([left, right, turn, head.translation_m - TRUTH.translation_m])


@cache
def calibration(seed: int, sag_m: float, shape: BoardShape) -> StereoResult:
    views = make_views(np.random.default_rng(seed), 30, sag_m=sag_m)
    return calibrate_stereo(views, BOARD, IMAGE_SIZE, shape=shape)


def calibrations(
    sag_m: float, shape: BoardShape = BoardShape.BENT, seeds: Iterable[int] = SEEDS
) -> list[StereoResult]:
    return [calibration(seed, sag_m, shape) for seed in seeds]


@pytest.fixture(
    params=[
        ONE,
        pytest.param(FEW, marks=pytest.mark.figures),
        pytest.param(SEEDS, marks=pytest.mark.long),
    ],
    ids=["one", "few", "all"],
)
def seeds(request: pytest.FixtureRequest) -> range:
    chosen = request.param
    assert isinstance(chosen, range)
    return chosen


@pytest.fixture
def flat(seeds: range) -> list[StereoResult]:
    return calibrations(0.0, seeds=seeds)


@pytest.fixture
def bowed(seeds: range) -> list[StereoResult]:
    return calibrations(BOW_M, seeds=seeds)


def rms(results: list[StereoResult]) -> Array:
    squares = [np.square(errors_m(result.head)) for result in results]
    return np.asarray(np.sqrt(np.mean(squares, axis=0)))


@pytest.mark.long
def test_bow_costs_nothing_when_the_board_is_released() -> None:
    flat, bowed = calibrations(0.0), calibrations(BOW_M)
    rigid_flat = calibrations(0.0, BoardShape.RIGID)
    assert (rms(bowed) < 1.3 * rms(flat)).all()
    assert (rms(bowed) < 1.3 * rms(rigid_flat)).all(), "nor against a board known to be flat"
    assert rms(flat)[1] < 6e-6


@pytest.mark.long
def test_bow_ruins_a_rigid_board_without_showing_in_the_residuals() -> None:
    bowed, rigid = calibrations(BOW_M), calibrations(BOW_M, BoardShape.RIGID)
    assert rms(rigid)[0] > 5 * rms(bowed)[0]
    assert all(result.head.rms_px < 0.1 and result.passed for result in rigid)


def test_flatness_of_the_board_is_found(
    flat: list[StereoResult], bowed: list[StereoResult]
) -> None:
    for result in flat:
        assert result.flatness_m < 8e-6
    for result in bowed:
        assert result.flatness_m == pytest.approx(BOW_M, abs=5e-6)


def test_covariance_matches_the_scatter(
    flat: list[StereoResult], bowed: list[StereoResult]
) -> None:
    total = 0.0
    for result in (*flat, *bowed):
        assert result.head.covariance is not None
        error = parameter_errors(result.head)
        scale = np.sqrt(np.diag(result.head.covariance))
        scaled = result.head.covariance / np.outer(scale, scale)
        total += float((error / scale) @ np.linalg.solve(scaled, error / scale))
    # The two sets share seeds, so only half of the freedom is independent.
    band = chi2(24 * len(flat)).interval(0.999)
    assert band[0] < total / 2 < band[1]


def test_noise_and_residuals_are_reported(bowed: list[StereoResult]) -> None:
    for result in bowed:
        assert result.sigma_px == pytest.approx(0.05, rel=0.05)
        assert result.head.rms_px == pytest.approx(0.05 * np.sqrt(2), rel=0.05)
        assert result.passed
        assert result.validation is not None
        # One corner triangulated from two views with 0.05 px: 20 to 30 µm, mostly in depth.
        assert 1.5e-5 < result.validation.held_out_m < 4e-5
        assert result.validation.difference_m < 8e-6


def test_print_with_another_aspect_ratio_needs_the_free_board() -> None:
    flat_m = BOARD.corners_m
    views = make_views(np.random.default_rng(3), 16)
    wrong = [_stretch(view, flat_m, 1e-4) for view in views]
    bent = calibrate_stereo(wrong, BOARD, IMAGE_SIZE)
    free = calibrate_stereo(wrong, BOARD, IMAGE_SIZE, shape=BoardShape.FREE)
    aspect = np.ptp(free.board_m[:, 0]) / np.ptp(flat_m[:, 0]) - np.ptp(
        free.board_m[:, 1]
    ) / np.ptp(flat_m[:, 1])
    assert aspect == pytest.approx(1e-4, abs=2e-5)
    assert free.sigma_px < bent.sigma_px


def _stretch(view: BoardView, flat_m: Array, ratio: float) -> BoardView:
    """Move the corners as if the board were longer by ``ratio`` along x."""

    def moved(corners: Corners) -> Corners:
        homography, *_ = np.linalg.lstsq(
            np.column_stack([_cubic(flat_m[corners.ids])]), corners.pixels, rcond=None
        )
        longer = flat_m[corners.ids] * [1 + ratio, 1, 1]
        shift = _cubic(longer) @ homography - _cubic(flat_m[corners.ids]) @ homography
        return Corners(corners.ids, corners.pixels + shift)

    return BoardView(view.name, moved(view.left), moved(view.right))


def _cubic(points: Array) -> Array:
    x, y = points[:, 0] / 0.1, points[:, 1] / 0.1
    return np.column_stack([x**i * y**j for i in range(4) for j in range(4 - i)])


def test_bad_view_is_named_and_left_out() -> None:
    rng = np.random.default_rng(11)
    views = make_views(rng, 14)
    noisy = views[7].left.pixels + rng.normal(0, 0.5, views[7].left.pixels.shape)
    views[7] = replace(views[7], left=Corners(views[7].left.ids, noisy))
    result = calibrate_stereo(views, BOARD, IMAGE_SIZE)
    assert [view.name for view in result.views if not view.used] == ["view-07"]
    assert any("view-07" in warning for warning in result.warnings)
    assert result.sigma_px == pytest.approx(0.05, rel=0.1)


def _moved(view: BoardView, du: float, dv: float, *, right: bool = False) -> BoardView:
    side = view.right if right else view.left
    corners = Corners(side.ids, side.pixels + np.array([du, dv]))
    return replace(view, right=corners) if right else replace(view, left=corners)


def _shuffled(corners: Corners) -> Corners:
    order = np.random.default_rng(0).permutation(len(corners.ids))
    return Corners(corners.ids, corners.pixels[order])


SPOILS: dict[str, tuple[Callable[[list[BoardView]], BoardView], str]] = {
    "the left picture of another pair": (
        lambda views: replace(views[5], left=views[4].left),
        "its left picture is that of view-04",
    ),
    "a pair stored twice": (
        lambda views: replace(views[4], name="view-05"),
        "its left and right pictures are those of view-04",
    ),
    "left and right exchanged": (
        lambda views: BoardView("view-05", views[5].right, views[5].left),
        "from where the others do",
    ),
    "the board moved between the exposures": (
        lambda views: replace(views[5], right=views[9].right),
        "from where the others do",
    ),
    "an image shifted by two pixels": (lambda views: _moved(views[5], 0, 2), "its corners are off"),
    "an image shifted by twenty": (lambda views: _moved(views[5], 0, 20), "its corners are off"),
    "an image cropped": (lambda views: _moved(views[5], 300, 0, right=True), "others"),
    "corners in another order": (
        lambda views: replace(views[5], right=_shuffled(views[5].right)),
        "right camera cannot have taken it",
    ),
}


@cache
def calibration_without_pair_5() -> StereoResult:
    """What is solved when the spoiled pair was never taken: the same whatever spoiled it."""
    views = make_views(np.random.default_rng(3), 14)
    return calibrate_stereo([*views[:5], *views[6:]], BOARD, IMAGE_SIZE)


QUICK = ("an image shifted by twenty", "corners in another order")
"""The adjustment finds the one, the start values show the other. All others are figures."""


@pytest.mark.parametrize("spoil", sweep(SPOILS, QUICK))
def test_one_bad_pair_is_named_with_its_reason_and_the_rest_is_solved(spoil: str) -> None:
    views = make_views(np.random.default_rng(3), 14)
    spoiled, reason = SPOILS[spoil]
    result = calibrate_stereo([*views[:5], spoiled(views), *views[6:]], BOARD, IMAGE_SIZE)
    assert [view.name for view in result.views if not view.used] == ["view-05"]
    assert any("left out: view-05" in said and reason in said for said in result.warnings)
    without = calibration_without_pair_5()
    np.testing.assert_allclose(
        result.head.translation_m, without.head.translation_m, rtol=0, atol=2e-8
    )


def test_several_bad_pairs() -> None:
    views = make_views(np.random.default_rng(3), 20)
    others = make_views(np.random.default_rng(4), 20)
    for index in (3, 9, 15):
        views[index] = replace(views[index], right=others[index].right)
    result = calibrate_stereo(views, BOARD, IMAGE_SIZE)
    assert [view.name for view in result.views if not view.used] == [
        "view-03",
        "view-09",
        "view-15",
    ]


def test_the_same_files_for_both_cameras() -> None:
    views = make_views(np.random.default_rng(0), 12)
    with pytest.raises(CameraSeenTwice, match="12 pairs"):
        calibrate_stereo([replace(view, right=view.left) for view in views], BOARD, IMAGE_SIZE)


@pytest.mark.figures
def test_covariance_is_honest_where_errors_hang_together_within_a_view() -> None:
    squares, moves = [], []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        views = hanging_together(make_views(rng, 20), rng, 0.05)
        result = calibrate_stereo(views, BOARD, IMAGE_SIZE)
        assert result.head.covariance is not None
        error, sigma = parameter_errors(result.head), np.sqrt(np.diag(result.head.covariance))
        scaled = result.head.covariance / np.outer(sigma, sigma)
        squares.append(float((error / sigma) @ np.linalg.solve(scaled, error / sigma)) / 24)
        moves += [view.shift_sigmas for view in result.views if view.shift_sigmas is not None]
    # Each is a chi square of 24 over its freedom, with a covariance from 20 views.
    assert 0.5 < np.mean(squares) < 2.5
    # All views together tell as much as the sum of their moves.
    assert 0.3 < float(np.sqrt(np.mean(np.square(moves)) * 20)) < 2.0


def test_record_survives_json() -> None:
    result = calibration(0, BOW_M, BoardShape.BENT)
    again = StereoResult.from_record(json.loads(json.dumps(result.to_record())))
    np.testing.assert_allclose(again.head.translation_m, result.head.translation_m, rtol=1e-12)
    assert again.head.covariance is not None
    assert result.head.covariance is not None
    np.testing.assert_allclose(again.head.covariance, result.head.covariance, rtol=1e-9)
    np.testing.assert_allclose(again.board_m, result.board_m, atol=0.51e-9)  # kept in nm
    assert again.checks == result.checks
    assert again.views == result.views
    assert again.board == result.board


def test_swapped_cameras() -> None:
    views = make_views(np.random.default_rng(0), 12)
    swapped = [BoardView(view.name, view.right, view.left) for view in views]
    with pytest.raises(CalibrationCamerasSwapped, match="left of the left one"):
        calibrate_stereo(swapped, BOARD, IMAGE_SIZE)


def test_one_camera_upside_down() -> None:
    views = make_views(np.random.default_rng(0), 12)
    turned = [replace(v, right=_turned_image(v.right)) for v in views]
    with pytest.raises(CalibrationCameraUpsideDown, match=r"turned by 1[5-9]"):
        calibrate_stereo(turned, BOARD, IMAGE_SIZE)


def _turned_image(corners: Corners) -> Corners:
    return Corners(corners.ids, np.array(IMAGE_SIZE) - 1 - corners.pixels)


def test_mixed_up_pairs() -> None:
    views = make_views(np.random.default_rng(0), 12)
    mixed = [
        replace(view, right=other.right)
        for view, other in zip(views, [*views[1:], views[0]], strict=True)
    ]
    with pytest.raises(PairsInconsistent, match="view-00"):
        calibrate_stereo(mixed, BOARD, IMAGE_SIZE)


def test_too_few_views() -> None:
    views = make_views(np.random.default_rng(0), 5)
    with pytest.raises(TooFewViews, match=r"5 usable views, at least 8 needed: view-00"):
        calibrate_stereo(views, BOARD, IMAGE_SIZE)


def test_views_that_leave_the_borders_out() -> None:
    small = CalibrationBoard(5, 4, 0.006)
    views = [
        view
        for view in make_views(np.random.default_rng(0), 60, board=small)
        if (np.abs(view.left.pixels.mean(axis=0) - np.array(IMAGE_SIZE) / 2) < 500).all()
    ]
    with pytest.raises(PoorCoverage, match="image cells"):
        calibrate_stereo(views[:12], small, IMAGE_SIZE)


def test_boards_that_always_face_the_camera() -> None:
    head = table_1_head()
    flat = BOARD.corners_m
    views = []
    for number, x in enumerate(np.linspace(-0.04, 0.04, 12)):
        points = flat + np.array([x, x / 2, 0.45 + 0.008 * number])
        sides = []
        for model, inside in (
            (head.left, points),
            (head.right, points @ head.rotation.T + head.translation_m),
        ):
            sides.append(Corners(np.arange(len(flat)), project(model, inside)))
        views.append(BoardView(f"view-{number}", *sides))
    with pytest.raises(PoorCoverage, match="tilt of the board"):
        calibrate_stereo(views, BOARD, IMAGE_SIZE)


def test_symmetric_board_is_matched_between_the_cameras() -> None:
    board = CalibrationBoard(12, 10, 0.016)
    views = make_views(np.random.default_rng(2), 16, board=board)
    last = board.columns * board.rows - 1
    flipped = [
        replace(v, right=Corners((last - v.right.ids)[::-1], v.right.pixels[::-1])) for v in views
    ]
    result = calibrate_stereo(flipped, board, IMAGE_SIZE)
    assert result.sigma_px == pytest.approx(0.05, rel=0.1)
