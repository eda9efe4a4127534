"""Views of one camera, and those of both cameras of a head taken for one."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.solvers.single_camera.two_cameras import MOST_PAIRED, share_of_pairs
from cellctl.geometry.pose import Array

HEAD = RigidTransform.from_components([-0.18, 0.0, 0.03], Rotation.from_rotvec([0.0, 0.35, 0.0]))
"""right_T_left of a head with toe-in."""


def moved_by_hand(rng: np.random.Generator, count: int) -> Array:
    turns = Rotation.from_euler("x", np.pi) * Rotation.from_rotvec(
        rng.uniform(-0.5, 0.5, (count, 3))
    )
    shifts_m = rng.uniform(-0.1, 0.1, (count, 3)) + np.array([0.0, 0.0, 0.5])
    return RigidTransform.from_components(shifts_m, turns).as_matrix()


@pytest.mark.parametrize("count", [8, 24])
def test_views_of_two_cameras_are_paired_off(count: int) -> None:
    left = moved_by_hand(np.random.default_rng(count), count)
    noise = np.random.default_rng(1).normal(0.0, 5e-4, (count, 3, 1))
    right = HEAD.as_matrix() @ left
    right[:, :3, 3:] += noise
    mixed = np.random.default_rng(2).permutation(np.concatenate([left, right]))
    assert share_of_pairs(mixed) == 1.0
    # A few strangers among them do not hide it.
    assert share_of_pairs(np.concatenate([mixed, left[:2] @ HEAD.as_matrix()])) > MOST_PAIRED


@pytest.mark.parametrize("seed", range(5))
def test_a_board_that_was_moved_by_hand_has_no_pairs(seed: int) -> None:
    assert share_of_pairs(moved_by_hand(np.random.default_rng(seed), 24)) <= 2 / 24


def test_neither_a_turntable_nor_a_grid_of_shifts_is_a_head() -> None:
    step = RigidTransform.from_components([0.02, 0.0, 0.001], Rotation.from_rotvec([0, 0.1, 0]))
    on_table = [moved_by_hand(np.random.default_rng(0), 1)[0]]
    for _ in range(11):
        on_table.append(step.as_matrix() @ on_table[-1])
    assert share_of_pairs(np.array(on_table)) <= MOST_PAIRED
    grid = moved_by_hand(np.random.default_rng(3), 6)
    shifted = grid.copy()
    shifted[:, 0, 3] += 0.05
    assert share_of_pairs(np.concatenate([grid, shifted])) <= MOST_PAIRED
