"""Closed-form hand-eye solution after Park and Martin, and the checks that need no solution.

With ``turn_i`` = base_T_flange (eye in hand) or its inverse (eye to hand) every pose obeys
``turn_i · X · camera_T_board_i = Z``. For two poses that is AX = XB (CG = GD) with
A = turn_j^-1 · turn_i and B = camera_T_board_j · camera_T_board_i^-1.
"""

from collections.abc import Sequence
from itertools import combinations

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
    alpha = np.stack([motion.rotation.as_rotvec() for motion in robot])
    beta = np.stack([motion.rotation.as_rotvec() for motion in camera])
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
    matrices = np.concatenate([motion.rotation.as_matrix() - np.eye(3) for motion in robot])
    knowns = np.concatenate(
        [rotation.apply(b.translation) - a.translation for a, b in zip(robot, camera, strict=True)]
    )
    translation = np.linalg.lstsq(matrices, knowns, rcond=None)[0]
    x = RigidTransform.from_components(translation, rotation)
    z = [turn * x * pose for turn, pose in zip(turns, camera_T_board, strict=True)]
    mean_rotation = Rotation.concatenate([pose.rotation for pose in z]).mean()
    # The median: a gross error among the poses must not pull the start.
    mean_translation = np.median([pose.translation for pose in z], axis=0)
    return x, RigidTransform.from_components(mean_translation, mean_rotation), spread


def board_scale(poses: Sequence[HandEyePose], setup: Setup) -> tuple[float, float]:
    """The robot's lengths over those of the board, and the standard deviation of that.

    1 when the board has the size that it was said to have. Raises ``PosesNotDiverse``.
    """
    turns = [setup.turn(pose.base_T_flange) for pose in poses]
    robot, camera = _motions(turns, [pose.camera_T_board.pose for pose in poses])
    alpha = np.stack([motion.rotation.as_rotvec() for motion in robot])
    beta = np.stack([motion.rotation.as_rotvec() for motion in camera])
    rotation, _ = Rotation.align_vectors(alpha, beta)
    matrices = np.stack([motion.rotation.as_matrix() - np.eye(3) for motion in robot])
    seen = np.stack([rotation.apply(motion.translation) for motion in camera])
    # (R_A - 1) t = s R t_B - t_A, with the scale s as a fourth unknown.
    design = np.concatenate([matrices, -seen[:, :, None]], axis=2).reshape(-1, 4)
    knowns = -np.concatenate([motion.translation for motion in robot])
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
    off = np.zeros((count, count))
    for i, j in combinations(range(count), 2):
        robot = (turns[j].inv() * turns[i]).rotation.magnitude()
        camera = (camera_T_board[j] * camera_T_board[i].inv()).rotation.magnitude()
        off[i, j] = off[j, i] = abs(robot - camera)
    # Each is compared with itself, too, and agrees: with few poses that must not decide.
    others = (off <= _MAX_ANGLE_DIFFERENCE_RAD).sum(axis=1) - 1
    return np.asarray(others >= (count - 1) / 2)


def _motions(
    turns: Sequence[RigidTransform], camera_T_board: Sequence[RigidTransform]
) -> tuple[list[RigidTransform], list[RigidTransform]]:
    """A and B for all pairs of poses that turn enough, but not by nearly half a turn."""
    robot, camera = [], []
    for i, j in combinations(range(len(turns)), 2):
        a = turns[j].inv() * turns[i]
        if _MIN_TURN_RAD <= a.rotation.magnitude() <= _MAX_TURN_RAD:
            robot.append(a)
            camera.append(camera_T_board[j] * camera_T_board[i].inv())
    # Two turns about different axes determine X; the third shows whether they belong together.
    if len(robot) < 3:
        raise PosesNotDiverse("fewer than three pairs of poses turn by 3° or more")
    return robot, camera
