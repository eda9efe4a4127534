import json

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform
from scipy.stats import chi2

from cellctl.calibration.boards.board_pose import (
    BoardPoint,
    BoardPose,
    fit_board,
    points_from_targets,
)
from cellctl.calibration.solvers.pose_average import average
from cellctl.calibration.solvers.transfer.board_transfer import (
    BoardPlacement,
    TransferResult,
    calibrate_board_transfer,
    head_2_in_head_1,
)
from cellctl.calibration.solvers.transfer.transfer_picture import transfer_picture
from cellctl.errors.calibration import BoardPoseInvalid
from cellctl.geometry.pose import pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.target_tracker import Target
from cellctl.processes.deck_to_frame.poses.deck_on_flange import deck_on_flange
from tests.rigs.calibration.board_placements import (
    BASE_T_C1,
    BASE_T_C2,
    C1_T_BOARD,
    C2_T_BOARD,
    C_T_BASE,
    DISCS,
    SMALL_SIGMA,
    board_points,
    calibrate,
    placement,
)


def nees(truth: RigidTransform, measured: UncertainPose) -> float:
    error = np.concatenate(pose_error(truth, measured.pose))
    return float(error @ np.linalg.solve(measured.covariance, error))


def test_equations_1_to_3() -> None:
    def seen(pose: RigidTransform) -> BoardPose:
        covariance_m2 = np.eye(3) * 1e-12
        exact = [
            BoardPoint(name, pose.apply(place), covariance_m2) for name, place in DISCS.items()
        ]
        return fit_board(DISCS, exact, disc_sigma_m=0)

    result = calibrate_board_transfer(
        UncertainPose.exact(C_T_BASE),
        [BoardPlacement(seen(C_T_BASE * BASE_T_C1 * C1_T_BOARD), seen(C1_T_BOARD))],
        [BoardPlacement(seen(C_T_BASE * BASE_T_C2 * C2_T_BOARD), seen(C2_T_BOARD))],
    )
    one, two = result.base_T_c1, result.base_T_c2
    np.testing.assert_allclose(one.pose.as_matrix(), BASE_T_C1.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(two.pose.as_matrix(), BASE_T_C2.as_matrix(), atol=1e-12)
    both = head_2_in_head_1(one, two).pose
    np.testing.assert_allclose(
        both.as_matrix(), (BASE_T_C1.inv() * BASE_T_C2).as_matrix(), atol=1e-12
    )


def test_equation_4() -> None:
    flange_T_deck = pose_from_xyzabc([3, -2, 502, 0.4, -0.3, 180])
    base_T_flange = pose_from_xyzabc([1900, 0, 967, 90, 0, 180])
    c1_T_deck = BASE_T_C1.inv() * base_T_flange * flange_T_deck
    sigma = np.diag([1e-5**2] * 3 + [1e-6**2] * 3)
    result = deck_on_flange(
        UncertainPose(base_T_flange, sigma),
        UncertainPose.exact(BASE_T_C1),
        UncertainPose.exact(c1_T_deck),
    )
    np.testing.assert_allclose(result.pose.as_matrix(), flange_T_deck.as_matrix(), atol=1e-12)
    # The turn of the flange acts on the deck's origin, half a metre away.
    assert result.sigma[:3].max() == pytest.approx(1e-5, rel=0.05)
    assert result.sigma[3:] == pytest.approx(1e-6, rel=1e-6)


@pytest.mark.parametrize(
    ("placements", "draws"),
    [
        (1, 10),
        pytest.param(1, 40, marks=pytest.mark.figures),
        pytest.param(3, 40, marks=pytest.mark.long),
    ],
)
def test_covariances_are_honest_for_each_pose(placements: int, draws: int) -> None:
    results = [calibrate(seed, placements) for seed in range(draws)]
    assert all(result.passed for result in results)
    band = chi2(6 * len(results)).interval(0.999)
    truths = {
        "base_T_c1": BASE_T_C1,
        "base_T_c2": BASE_T_C2,
        "c1_T_c2": BASE_T_C1.inv() * BASE_T_C2,
    }
    for name, truth in truths.items():
        total = sum(nees(truth, getattr(result, name)) for result in results)
        # Covariances grow where a fit scatters more than stated, never shrink: low side is lower.
        assert 0.7 * band[0] < total < band[1], name


def test_base_cancels_between_the_heads() -> None:
    """The covariance of C1_T_C2 must not contain C_T_B, which plain propagation counts twice."""
    result = calibrate(1)
    plain = head_2_in_head_1(result.base_T_c1, result.base_T_c2)
    np.testing.assert_allclose(plain.pose.as_matrix(), result.c1_T_c2.pose.as_matrix(), atol=1e-12)
    assert (result.c1_T_c2.sigma[3:] < plain.sigma[3:]).all()


def test_more_placements_help() -> None:
    assert (calibrate(2, 4).c1_T_c2.sigma < 0.6 * calibrate(2, 1).c1_T_c2.sigma).all()


def test_record_and_picture() -> None:
    result = calibrate(3, 2)
    again = TransferResult.from_record(json.loads(json.dumps(result.to_record())))
    for name in ("base_T_c1", "base_T_c2", "c1_T_c2"):
        mine, theirs = getattr(result, name), getattr(again, name)
        np.testing.assert_allclose(theirs.pose.as_matrix(), mine.pose.as_matrix(), atol=1e-12)
        np.testing.assert_allclose(theirs.covariance, mine.covariance, rtol=1e-9)
    assert again.residuals_m.keys() == result.residuals_m.keys()
    assert transfer_picture(again).startswith(b"\x89PNG")


def test_a_wrong_disc_is_left_out_and_named() -> None:
    rng = np.random.default_rng(0)
    points = board_points(rng, C1_T_BOARD, SMALL_SIGMA)
    points[3] = BoardPoint(
        "P4", points[3].position_m + np.array([0, 1e-3, 0]), points[3].covariance_m2
    )
    board = fit_board(DISCS, points)
    assert board.outliers == ("P4",)
    error = np.concatenate(pose_error(C1_T_BOARD, board.head_T_board.pose))
    assert np.abs(error[:3]).max() < 3e-5


def test_boards_that_cannot_be_fitted() -> None:
    rng = np.random.default_rng(0)
    points = board_points(rng, C1_T_BOARD, SMALL_SIGMA)
    with pytest.raises(BoardPoseInvalid, match="3 discs"):
        fit_board(DISCS, points[:3])
    four = {**DISCS, "P10": np.array([0.2, -0.08, 0.0])}
    extra = BoardPoint("P10", C1_T_BOARD.apply(four["P10"]), points[0].covariance_m2)
    with pytest.raises(BoardPoseInvalid, match="on a line"):
        fit_board(four, [*points[:3], extra])
    with pytest.raises(BoardPoseInvalid, match="not on the board: F1"):
        fit_board(DISCS, [*points, BoardPoint("F1", np.zeros(3), np.eye(3))])
    with pytest.raises(BoardPoseInvalid, match=f"measured twice: {points[0].name}"):
        fit_board(DISCS, [*points[:3], points[0]])
    wrong = [
        BoardPoint(name, point.position_m, point.covariance_m2)
        for name, point in zip(["P2", "P1", "P5", "P4", "P3"], points, strict=False)
    ]
    with pytest.raises(BoardPoseInvalid, match="mm rms off"):
        fit_board(DISCS, wrong)
    with pytest.raises(BoardPoseInvalid, match="head II"):
        calibrate_board_transfer(UncertainPose.exact(C_T_BASE), [calibrate_placement(rng)], [])


def calibrate_placement(rng: np.random.Generator) -> BoardPlacement:
    return placement(rng, BASE_T_C1, C1_T_BOARD)


def test_only_the_discs_of_the_board_are_taken_from_the_large_field_head() -> None:
    seen = (Target("F1", np.zeros(3), 5e-5), Target("P5", np.ones(3), 5e-5))
    (point,) = points_from_targets(seen, DISCS)
    assert point.name == "P5"
    np.testing.assert_allclose(np.diag(point.covariance_m2), 25e-10)


def test_average_of_poses_weighs_and_judges() -> None:
    exact = UncertainPose(C1_T_BOARD, np.eye(6) * 1e-12)
    off = RigidTransform.from_components(
        C1_T_BOARD.translation + np.array([1e-3, 0, 0]), C1_T_BOARD.rotation
    )
    mean, ratio = average([exact, UncertainPose(off, np.eye(6) * 1e-6)])
    assert abs(mean.pose.translation[0] - C1_T_BOARD.translation[0]) < 2e-9
    assert ratio < 1
    _, disagreement = average([exact, UncertainPose(off, np.eye(6) * 1e-12)])
    assert disagreement > 1e3
