"""Two parts compared by heads that have moved against each other since they were calibrated."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform
from scipy.stats import chi2

from cellctl.geometry.pose import Array, pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose, perturbed
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.part_pose import PartPose, part_pose
from cellctl.vision.registration.relative_pose import RelativePose, relative_pose
from tests.unit.vision.registration.test_part_pose import C1_T_C2, HOLES, measured

C1_T_FRAME = pose_from_xyzabc([470, 190, 500, 1, -9, 181])
FRAME_T_DECK = pose_from_xyzabc([0.03, -0.02, 15.04, 0.004, 0.003, -0.002])
DRIFT = np.repeat([1e-4, np.radians(0.01)], 3)
FRAME_SIGMAS = np.array([0.3, 4.0, 4.0, 4.0, 0.3, 4.0])
"""Standard deviations of the holes, as multiples of a deck's: two pins, and threads that are
seen far worse."""
SIGMA_M = np.array([1e-6, 1e-6, 5e-6])


def seen(rng: np.random.Generator, part: RigidTransform, moved: Array, sigmas: Array) -> PartPose:
    """A part as two heads measure it, of which the second has moved."""
    in_c1 = part.apply(np.array([hole.position_m for hole in HOLES]))
    c2 = perturbed(C1_T_C2, moved)
    noise = rng.normal(size=(6, 3)) * SIGMA_M * sigmas[:, None]
    found = []
    for rows, pose in ((slice(0, 3), RigidTransform.identity()), (slice(3, 6), c2)):
        pair = measured(HOLES[rows], pose.inv().apply(in_c1[rows]) + noise[rows])
        covariances = [np.diag((SIGMA_M * one) ** 2) for one in sigmas[rows]]
        holes = tuple(
            replace(hole, covariance_m2=covariance)
            for hole, covariance in zip(pair.holes, covariances, strict=True)
        )
        found.append(replace(pair, holes=holes))
    known = UncertainPose(C1_T_C2, np.diag(DRIFT**2))
    return part_pose(found[0], found[1], known, HOLES, residual_limit_m=1e-3)


def both(rng: np.random.Generator, moved: Array) -> tuple[PartPose, PartPose]:
    deck = C1_T_FRAME * FRAME_T_DECK
    return seen(rng, C1_T_FRAME, moved, FRAME_SIGMAS), seen(rng, deck, moved, np.ones(6))


def together(frame: PartPose, deck: PartPose) -> RelativePose:
    poses = frame.pose.pose, deck.pose.pose
    return relative_pose(frame.points, deck.points, *poses, np.diag(DRIFT**2))


def error(measured_pose: RigidTransform) -> Array:
    return np.concatenate(pose_error(FRAME_T_DECK, measured_pose))


def test_heads_that_moved_hardly_move_the_deck() -> None:
    rng = np.random.default_rng(1)
    one_by_one, jointly = [], []
    for _ in range(40):
        frame, deck = both(rng, rng.normal(size=6) * DRIFT)
        one_by_one.append(error(frame.pose.pose.inv() * deck.pose.pose))
        jointly.append(error(together(frame, deck).part_1_T_part_2.pose))
    apart, joint = (np.sqrt(np.mean(np.square(all_), axis=0)) for all_ in (one_by_one, jointly))
    lateral = slice(0, 2)
    assert apart[lateral].min() > 3e-6
    assert joint[lateral].max() < 2e-6
    assert (joint < 1.1 * apart).all(), "and nothing is paid for it"


@pytest.mark.parametrize(
    "draws",
    [
        10,
        pytest.param(50, marks=pytest.mark.figures),
        pytest.param(200, marks=pytest.mark.long),
    ],
)
def test_the_covariance_is_honest_whatever_the_heads_did(draws: int) -> None:
    rng = np.random.default_rng(2)
    squared, misfits = [], []
    for _ in range(draws):
        result = together(*both(rng, rng.normal(size=6) * DRIFT))
        off = error(result.part_1_T_part_2.pose)
        squared.append(float(off @ np.linalg.solve(result.part_1_T_part_2.covariance, off)))
        misfits.append(result.misfit.chi2)
        freedom = result.misfit.freedom
    band = chi2(6 * len(squared)).interval(0.999)
    assert 0.9 * band[0] < sum(squared) < band[1]
    # The mean of so many values of chi-square scatters by sqrt(2 / (freedom draws)) of itself.
    scatter = np.sqrt(2.0 / (freedom * draws))
    assert np.mean(misfits) == pytest.approx(freedom, rel=max(0.05, 3.3 * scatter))


@pytest.mark.parametrize(
    ("frames", "draws"),
    [
        (4, 15),
        pytest.param(1, 60, marks=pytest.mark.figures),
        pytest.param(4, 60, marks=pytest.mark.figures),
    ],
)
def test_the_covariance_is_honest_when_the_arms_of_the_heads_sway(frames: int, draws: int) -> None:
    rng, sway_m, squared = np.random.default_rng(4), 5e-6, []
    for _ in range(draws):
        parts = []
        for part in both(rng, np.zeros(6)):
            shift = rng.normal(size=(2, 3)) * [sway_m, sway_m, 0.0] / np.sqrt(frames)
            points = part.points
            shifted = points.measured_m + np.repeat(shift, 3, axis=0)
            parts.append(replace(part, points=replace(points, measured_m=shifted, frames=frames)))
        frame, deck = parts
        poses = frame.pose.pose, deck.pose.pose
        found = relative_pose(frame.points, deck.points, *poses, np.diag(DRIFT**2), sway_m=sway_m)
        off = error(found.part_1_T_part_2.pose)
        squared.append(float(off @ np.linalg.solve(found.part_1_T_part_2.covariance, off)))
    band = chi2(6 * len(squared)).interval(0.999)
    assert 0.9 * band[0] < sum(squared) < band[1]


def test_the_movement_of_the_heads_is_found() -> None:
    moved = DRIFT * np.array([1.5, -1.0, 1.0, 0.0, 0.0, 0.0])
    result = together(*both(np.random.default_rng(3), moved))
    # The error of what is known: opposite to what the head did.
    np.testing.assert_allclose(result.movement[:3], -moved[:3], atol=6e-5)


def test_points_of_one_head_alone_need_no_transfer() -> None:
    nominal_m = np.array([hole.position_m for hole in HOLES])
    covariances = np.tile(np.eye(3) * 1e-12, (6, 1, 1))

    def part(pose: RigidTransform) -> MeasuredPoints:
        names = tuple(hole.name for hole in HOLES)
        return MeasuredPoints(
            names, nominal_m, pose.apply(nominal_m), covariances, np.zeros((6, 3, 6))
        )

    deck = C1_T_FRAME * FRAME_T_DECK
    found = relative_pose(part(C1_T_FRAME), part(deck), C1_T_FRAME, deck, np.diag(DRIFT**2))
    assert np.abs(error(found.part_1_T_part_2.pose)).max() < 1e-12
    assert np.abs(found.movement).max() < 1e-12
