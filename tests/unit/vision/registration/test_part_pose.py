from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.vision import HeadsMoved, ResidualsTooLarge, TooFewHoles
from cellctl.geometry.pose import Array, pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import HoleMeasurement, Method, PairMeasurement
from cellctl.vision.registration.part_pose import part_pose
from tests.rigs.sweeps import sweep

XY_MM = [(-480, -180), (-480, -80), (-400, -230), (400, 230), (480, 180), (480, 80)]
HOLES = tuple(
    Hole(f"P{index}", "pin", 6e-3, np.array([x, y, 0.0]) * 1e-3)
    for index, (x, y) in enumerate(XY_MM, start=1)
)
C1_T_PART = pose_from_xyzabc([470, 190, 500, 1, -9, 181])
C1_T_C2 = pose_from_xyzabc([900, 350, 20, 2, 3, 179])
SIGMA_M = np.array([0.5e-6, 0.5e-6, 2.5e-6])


def measured(holes: tuple[Hole, ...], points_m: Array) -> PairMeasurement:
    none, ellipse = np.zeros(2), Ellipse(np.zeros(2), (1.0, 1.0), 0.0)
    return PairMeasurement(
        "default",
        tuple(
            HoleMeasurement(
                hole.name, hole.kind, none, none, np.eye(2), np.eye(2), point,
                np.diag(SIGMA_M**2), ellipse, ellipse, hole.diameter_m, 0.0,
            )
            for hole, point in zip(holes, points_m, strict=True)
        ),
    )  # fmt: skip


def heads(
    noise: Array, transfer: RigidTransform = C1_T_C2
) -> tuple[PairMeasurement, PairMeasurement]:
    """What both heads measure; the true transform between them may differ from the known one."""
    nominal = np.array([hole.position_m for hole in HOLES])
    in_c1 = C1_T_PART.apply(nominal)
    head_1 = measured(HOLES[:3], in_c1[:3] + noise[:3])
    head_2 = measured(HOLES[3:], transfer.inv().apply(in_c1[3:]) + noise[3:])
    return head_1, head_2


@pytest.mark.parametrize("method", ["default", "paper"])
def test_without_noise_the_pose_is_exact(method: Method) -> None:
    result = part_pose(
        *heads(np.zeros((6, 3))),
        UncertainPose.exact(C1_T_C2),
        HOLES,
        method,
    )
    translation_m, rotation_rad = pose_error(C1_T_PART, result.pose.pose)
    assert np.abs(translation_m).max() < 1e-12
    assert np.abs(rotation_rad).max() < 1e-12
    assert np.abs(result.residuals_m).max() < 1e-12


@pytest.mark.parametrize(
    ("method", "draws"),
    [
        ("default", 75),
        pytest.param("default", 300, marks=pytest.mark.long),
        pytest.param("paper", 300, marks=pytest.mark.long),
    ],
)
def test_the_covariance_is_that_of_the_scatter_and_contains_the_transfer(
    method: Method, draws: int
) -> None:
    rng = np.random.default_rng(5)
    transfer_sigma = np.array([20e-6, 20e-6, 20e-6, 3e-5, 3e-5, 3e-5])
    known = UncertainPose(C1_T_C2, np.diag(transfer_sigma**2))
    squared, own = [], []
    for _ in range(draws):
        slip = rng.normal(size=6) * transfer_sigma
        true = RigidTransform.from_components(
            C1_T_C2.translation - slip[:3], Rotation.from_rotvec(-slip[3:]) * C1_T_C2.rotation
        )
        result = part_pose(
            *heads(rng.normal(size=(6, 3)) * SIGMA_M, true),
            known,
            HOLES,
            method,
        )
        error = np.concatenate(pose_error(C1_T_PART, result.pose.pose))
        squared.append(error @ np.linalg.solve(result.pose.covariance, error))
        own.append(np.trace(result.own_covariance) / np.trace(result.pose.covariance))
    assert abs(np.mean(squared) - 6.0) < 4.0 * np.sqrt(12.0 / draws)
    assert np.mean(own) < 0.2


def test_one_wrong_hole_is_left_out_and_named() -> None:
    noise = np.random.default_rng(2).normal(size=(6, 3)) * SIGMA_M
    noise[3] += [0.0, 0.4e-3, 0.3e-3]
    result = part_pose(*heads(noise), UncertainPose.exact(C1_T_C2), HOLES)
    assert result.outliers == ("P4",)
    translation_m, _ = pose_error(C1_T_PART, result.pose.pose)
    assert np.abs(translation_m).max() < 10e-6
    assert np.linalg.norm(result.residuals_m[3]) > 0.4e-3


def test_a_part_that_does_not_fit_is_refused() -> None:
    noise = np.random.default_rng(2).normal(size=(6, 3)) * 0.5e-3
    with pytest.raises(ResidualsTooLarge, match="P1"):
        part_pose(*heads(noise), UncertainPose.exact(C1_T_C2), HOLES)


def test_too_few_holes() -> None:
    head_1, head_2 = heads(np.zeros((6, 3)))
    short = PairMeasurement("default", head_1.holes[:2])
    with pytest.raises(TooFewHoles, match="P1, P2"):
        part_pose(short, None, None, HOLES)
    with pytest.raises(TooFewHoles, match="six"):
        part_pose(head_1, None, None, HOLES, "paper")
    with pytest.raises(ValueError, match="c1_T_c2"):
        part_pose(head_1, head_2, None, HOLES)


@pytest.mark.parametrize("draws", [20, pytest.param(200, marks=pytest.mark.figures)])
def test_the_misfit_is_of_its_expected_size_with_an_uncertain_transfer(draws: int) -> None:
    rng = np.random.default_rng(11)
    sigma = np.array([2e-5, 2e-5, 4e-5, 5e-5, 5e-5, 5e-5])
    known = UncertainPose(C1_T_C2, np.diag(sigma**2))
    found = []
    for _ in range(draws):
        noise, off = rng.normal(size=(6, 3)) * SIGMA_M, rng.normal(size=6) * sigma
        true = RigidTransform.from_components(
            C1_T_C2.translation + off[:3], Rotation.from_rotvec(off[3:]) * C1_T_C2.rotation
        )
        found.append(part_pose(*heads(noise, true), known, HOLES).misfit)
    assert {misfit.freedom for misfit in found} == {12}
    # The mean of values of 12 degrees of freedom scatters by the root of 24 over their number.
    scatter = np.sqrt(24.0 / draws)
    assert np.mean([misfit.chi2 for misfit in found]) == pytest.approx(12.0, abs=3.4 * scatter)
    assert np.sum([misfit.growth > 1.0 for misfit in found]) <= max(2, 0.05 * draws)


def test_a_part_off_its_drawing_makes_the_pose_less_sure() -> None:
    off = np.zeros((6, 3))
    off[1, 0] = 60e-6
    exact = UncertainPose.exact(C1_T_C2)
    good, odd = (part_pose(*heads(noise), exact, HOLES) for noise in (np.zeros((6, 3)), off))
    assert odd.outliers == ()
    assert odd.misfit.growth > 100.0
    assert odd.pose.sigma.max() > 10.0 * good.pose.sigma.max()
    own = [np.diag(result.own_covariance) for result in (good, odd)]
    np.testing.assert_allclose(own[0], own[1], rtol=1e-2)


def test_heads_that_moved_are_not_taken_for_a_wrong_part() -> None:
    moved = RigidTransform.from_translation([0.6e-3, 0.0, 0.0]) * C1_T_C2
    known = UncertainPose(C1_T_C2, np.diag(np.repeat([3e-4, 1e-4], 3) ** 2))
    noise = np.random.default_rng(4).normal(size=(6, 3)) * SIGMA_M
    result = part_pose(*heads(noise, moved), known, HOLES)
    assert not result.outliers
    assert np.linalg.norm(result.residuals_m, axis=1).max() < 2e-5
    with pytest.raises(ResidualsTooLarge):
        part_pose(*heads(noise, moved), UncertainPose(C1_T_C2, np.eye(6) * 1e-12), HOLES)


def test_a_hole_off_the_drawing_is_left_out_whatever_the_heads_may_have_done() -> None:
    noise = np.random.default_rng(5).normal(size=(6, 3)) * SIGMA_M
    noise[4] += [0.6e-3, 0.0, 0.0]
    known = UncertainPose(C1_T_C2, np.diag(np.repeat([1e-4, 1.7e-4], 3) ** 2))
    result = part_pose(*heads(noise), known, HOLES)
    assert result.outliers == ("P5",)


def test_holes_off_their_drawing_are_explained_when_the_drawing_says_so() -> None:
    rng = np.random.default_rng(6)
    off_m = np.column_stack([rng.normal(size=(6, 2)) * 10e-6, np.zeros(6)])
    in_c1 = C1_T_PART.rotation.apply(off_m)
    images = heads(in_c1)
    # The noise of the second head is in its own axes.
    images = images[0], heads(C1_T_C2.rotation.inv().apply(in_c1))[1]
    known = UncertainPose(C1_T_C2, np.eye(6) * 1e-16)
    silent = part_pose(*images, known, HOLES)
    said = part_pose(*images, known, [replace(hole, position_sigma_m=10e-6) for hole in HOLES])
    assert silent.misfit.growth > 20
    assert said.misfit.growth == 1.0
    assert said.pose.sigma[5] > 3 * np.sqrt(silent.own_covariance[5, 5])
    assert said.pose.sigma[2] == pytest.approx(np.sqrt(silent.own_covariance[2, 2]), rel=0.2)


def test_more_images_would_not_help_against_holes_off_their_drawing() -> None:
    images = heads(np.random.default_rng(7).normal(size=(6, 3)) * SIGMA_M)
    known = UncertainPose(C1_T_C2, np.eye(6) * 1e-16)
    said = part_pose(*images, known, [replace(hole, position_sigma_m=10e-6) for hole in HOLES])
    exact = part_pose(*images, known, HOLES)
    np.testing.assert_allclose(exact.image_covariance, exact.own_covariance)
    # The weights are others when the drawing is not trusted, so the images' share is no smaller.
    assert exact.own_covariance[5, 5] <= said.image_covariance[5, 5] < said.own_covariance[5, 5] / 4


DRIFT = UncertainPose(C1_T_C2, np.diag(np.repeat([1e-4, np.radians(0.01)], 3) ** 2))
"""What the recipe of the deck says of the heads: a movement of 0.1 mm and 0.01 degrees."""


@pytest.mark.parametrize(
    "moved",
    [[0.9, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.1],
     [-3.0, 2.0, 1.0, 0.1, -0.1, 0.2]],
)  # fmt: skip
def test_a_moved_head_is_told_from_a_bad_part(moved: list[float]) -> None:
    rng = np.random.default_rng(3)
    slip = pose_from_xyzabc(moved)
    with pytest.raises(HeadsMoved, match="head II has moved by"):
        part_pose(*heads(rng.normal(size=(6, 3)) * SIGMA_M, C1_T_C2 * slip), DRIFT, HOLES)


def test_a_small_movement_is_taken_into_account_and_no_fault() -> None:
    slip = pose_from_xyzabc([0.2, -0.1, 0.05, 0.0, 0.0, 0.01])
    result = part_pose(*heads(np.zeros((6, 3)), C1_T_C2 * slip), DRIFT, HOLES)
    assert np.linalg.norm(result.residuals_m, axis=1).max() < 50e-6


@pytest.mark.parametrize("seed", sweep(range(20), range(5)))
def test_a_part_with_two_wrong_holes_is_not_a_moved_head(seed: int) -> None:
    """Each hole 0.8 mm off in a direction of its own, one before each head or both before one."""
    rng = np.random.default_rng(seed)
    wrong = rng.normal(size=(6, 3)) * SIGMA_M
    for index in rng.choice(6, 2, replace=False):
        across = rng.normal(size=2)
        wrong[index, :2] += 0.8e-3 * across / np.linalg.norm(across)
    with pytest.raises(ResidualsTooLarge, match="residuals in mm"):
        part_pose(*heads(wrong), DRIFT, HOLES)
