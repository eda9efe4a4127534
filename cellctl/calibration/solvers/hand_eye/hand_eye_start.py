"""Closed-form hand-eye solution after Park and Martin, and the checks that need no solution.

With ``turn_i`` = base_T_flange (eye in hand) or its inverse (eye to hand) every pose obeys
``turn_i · X · camera_T_board_i = Z``. For two poses that is AX = XB (CG = GD) with
A = turn_j^-1 · turn_i and B = camera_T_board_j · camera_T_board_i^-1.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, Setup
from cellctl.errors.calibration import PosesNotDiverse, RobotCameraMismatch
from cellctl.geometry.pose import Array

MIN_POSES = 4
"""Three poses that turn about two directions determine camera and board; the fourth shows whether
they belong together."""
_MIN_TURN_RAD, _MAX_TURN_RAD = np.radians(3), np.radians(170)
"""Small turns have an uncertain axis; at half a turn the sign of the axis is arbitrary."""
_MIN_SPREAD_RAD = np.radians(5)
"""Rms turn of the flange in the second direction. Turns about one direction leave the place of the
camera along it open, and little more than that multiplies the errors of the poses."""
_MAX_ANGLE_DIFFERENCE_RAD = np.radians(1)
"""Robot and camera know an angle to hundredths of a degree: more than this is another motion."""


def closed_form(
    turns: Sequence[RigidTransform], camera_T_board: Sequence[RigidTransform]
) -> tuple[RigidTransform, RigidTransform, Array]:
    """X, Z and the spread of the turns (rad rms along the three principal directions, falling).

    Raises ``PosesNotDiverse`` or ``RobotCameraMismatch``.
    """
    if len(turns) < MIN_POSES:
        raise PosesNotDiverse(f"{len(turns)} poses, at least {MIN_POSES} needed")
    robot, camera = _motions(turns, camera_T_board)
    alpha, beta = robot.rotation.as_rotvec(), camera.rotation.as_rotvec()
    angles = np.linalg.norm(alpha, axis=1)
    # A rotation has the same angle in every frame, so robot and camera must agree on it.
    off = float(np.median(np.abs(angles - np.linalg.norm(beta, axis=1))))
    if off > _MAX_ANGLE_DIFFERENCE_RAD:
        raise RobotCameraMismatch(
            f"robot and camera turn by angles that differ by {np.degrees(off):.1f}° (median)"
        )
    spread = np.linalg.svd(alpha, compute_uv=False) / np.sqrt(len(alpha))
    if spread[1] < _MIN_SPREAD_RAD:
        raise PosesNotDiverse(
            f"the flange turns about one direction only; across it {np.degrees(spread[1]):.1f}° rms"
        )
    # Rotation first: axes transform like vectors, R beta = alpha. Translation is linear then.
    # Longer rotation vectors weigh more in this fit, as they should: their direction is better
    # known.
    rotation, _ = Rotation.align_vectors(alpha, beta)
    matrices = robot.rotation.as_matrix() - np.eye(3)
    knowns = rotation.apply(camera.translation) - robot.translation
    translation = np.linalg.lstsq(matrices.reshape(-1, 3), knowns.ravel(), rcond=None)[0]
    x = RigidTransform.from_components(translation, rotation)
    z = RigidTransform.concatenate(turns) * x * RigidTransform.concatenate(camera_T_board)
    # The median: a gross error among the poses must not pull the start.
    mean_translation = np.median(z.translation, axis=0)
    return x, RigidTransform.from_components(mean_translation, z.rotation.mean()), spread


def board_scale(poses: Sequence[HandEyePose], setup: Setup) -> tuple[float, float]:
    """The robot's lengths over those of the board, and the standard deviation of that.

    1 when the board has the size that it was said to have. Raises ``PosesNotDiverse``.
    """
    turns = [setup.turn(pose.base_T_flange) for pose in poses]
    robot, camera = _motions(turns, [pose.camera_T_board.pose for pose in poses])
    alpha, beta = robot.rotation.as_rotvec(), camera.rotation.as_rotvec()
    rotation, _ = Rotation.align_vectors(alpha, beta)
    matrices = robot.rotation.as_matrix() - np.eye(3)
    seen = rotation.apply(camera.translation)
    # (R_A - 1) t = s R t_B - t_A, with the scale s as a fourth unknown.
    design = np.concatenate([matrices, -seen[:, :, None]], axis=2).reshape(-1, 4)
    knowns = -robot.translation.ravel()
    solution, *_ = np.linalg.lstsq(design, knowns, rcond=None)
    left = knowns - design @ solution
    # Pairs of poses are no independent measurements: as many as there are poses are.
    freedom = max(3 * len(poses) - 7, 1)
    variance = float(left @ left) / len(knowns) * (3 * len(poses)) / freedom
    inverse = np.linalg.pinv(design.T @ design * (3.0 * len(poses) / len(knowns)))
    return float(solution[3]), float(np.sqrt(variance * inverse[3, 3]))


def turns_agree(
    turns: Sequence[RigidTransform], camera_T_board: Sequence[RigidTransform]
) -> NDArray[np.bool_]:
    """Poses at which robot and camera turn by the same angle, seen from most other poses.

    A picture of another pose, or a board that was taken for turned, turns the camera otherwise.
    Shape (poses,).
    """
    count = len(turns)
    if count < 2:
        return np.ones(count, dtype=np.bool_)  # nothing to compare; that they are few is told later
    robot, camera = _between_all(turns, camera_T_board)
    off = np.zeros((count, count))
    off[np.triu_indices(count, 1)] = np.abs(
        robot.rotation.magnitude() - camera.rotation.magnitude()
    )
    off += off.T
    # Each is compared with itself, too, and agrees: with few poses that must not decide.
    others = (off <= _MAX_ANGLE_DIFFERENCE_RAD).sum(axis=1) - 1
    return np.asarray(others >= (count - 1) / 2)


def _motions(
    turns: Sequence[RigidTransform], camera_T_board: Sequence[RigidTransform]
) -> tuple[RigidTransform, RigidTransform]:
    """A and B for all pairs of poses that turn enough, but not by nearly half a turn."""
    robot, camera = _between_all(turns, camera_T_board)
    angles = robot.rotation.magnitude()
    chosen = np.flatnonzero((angles >= _MIN_TURN_RAD) & (angles <= _MAX_TURN_RAD))
    # Two turns about different axes determine X; the third shows whether they belong together.
    if len(chosen) < 3:
        raise PosesNotDiverse("fewer than three pairs of poses turn by 3° or more")
    return robot[chosen], camera[chosen]


def _between_all(
    turns: Sequence[RigidTransform], camera_T_board: Sequence[RigidTransform]
) -> tuple[RigidTransform, RigidTransform]:
    """A and B for all pairs of poses, in the order of ``numpy.triu_indices``."""
    # All in one: of twenty poses there are 190 pairs, and each operation of a single transform
    # costs a hundred times its arithmetic.
    first, second = np.triu_indices(len(turns), 1)
    flange, board = RigidTransform.concatenate(turns), RigidTransform.concatenate(camera_T_board)
    return flange[second].inv() * flange[first], board[second] * board[first].inv()
