"""A board before the large-field head and one small head, with known truth."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board_pose import (
    BoardPoint,
    fit_board,
    target_board_discs,
)
from cellctl.calibration.solvers.transfer.board_transfer import (
    BoardPlacement,
    TransferResult,
    calibrate_board_transfer,
)
from cellctl.geometry.pose import Array, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose

DISCS = target_board_discs()
C_T_BASE = pose_from_xyzabc([1300, 30, 6000, 10, 1, 179]).inv()
BASE_T_C1 = pose_from_xyzabc([1700, -480, 920, 90, 0, 180])
BASE_T_C2 = pose_from_xyzabc([2100, 480, 925, -88, 1, 179])
C1_T_BOARD = pose_from_xyzabc([0, 5, 508, 3, -170, 2])
C2_T_BOARD = pose_from_xyzabc([10, -5, 500, -5, 172, -3])
LARGE_SIGMA_M, SMALL_SIGMA = 1.1e-5, np.array([1e-6, 1e-6, 5e-6])
BASE_SIGMA = np.array([2e-5] * 3 + [2e-5] * 3)


def board_points(rng: np.random.Generator, pose: RigidTransform, sigma: Array) -> list[BoardPoint]:
    return [
        BoardPoint(name, pose.apply(place) + rng.normal(0, sigma, 3), np.diag(sigma**2))
        for name, place in DISCS.items()
    ]


def placement(rng: np.random.Generator, base_T_head: RigidTransform, head_T_board: RigidTransform,
              ) -> BoardPlacement:  # fmt: skip
    c_T_board = C_T_BASE * base_T_head * head_T_board
    large = board_points(rng, c_T_board, np.full(3, LARGE_SIGMA_M))
    small = board_points(rng, head_T_board, SMALL_SIGMA)
    return BoardPlacement(
        fit_board(DISCS, large, disc_sigma_m=0), fit_board(DISCS, small, disc_sigma_m=0)
    )


def calibrate(seed: int, placements: int = 1) -> TransferResult:
    rng = np.random.default_rng(seed)
    noise = rng.normal(0, BASE_SIGMA)
    c_T_base = RigidTransform.from_components(
        C_T_BASE.translation + noise[:3], Rotation.from_rotvec(noise[3:]) * C_T_BASE.rotation
    )
    tilts = [pose_from_xyzabc([10 * n, 0, 5 * n, 3 * n, 2, n]) for n in range(placements)]
    return calibrate_board_transfer(
        UncertainPose(c_T_base, np.diag(BASE_SIGMA**2)),
        [placement(rng, BASE_T_C1, C1_T_BOARD * tilt) for tilt in tilts],
        [placement(rng, BASE_T_C2, C2_T_BOARD * tilt) for tilt in tilts],
    )
