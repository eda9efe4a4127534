"""Hand-eye calibration: AX = XB (eye in hand) and CG = GD (eye to hand).

A closed form starts a weighted maximum-likelihood solution: each pose's residual is weighted with
the covariance of the camera's pose and of the robot's pose, in the proportions that the residuals
themselves show. ``make bench-hand-eye`` compares it with closed forms (docs/calibration.md).
"""

from collections.abc import Sequence
from itertools import compress

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.hand_eye.hand_eye_adjustment import (
    adjust_hand_eye,
    residuals_of,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_limits import HandEyeLimits, mounting_check
from cellctl.calibration.solvers.hand_eye.hand_eye_mistakes import (
    all_inverted,
    another_size,
    board_distance_m,
    explanation,
    odd_poses,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_result import (
    HandEyePose,
    HandEyeResult,
    RobotNoise,
    Setup,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_start import (
    MIN_POSES,
    board_scale,
    closed_form,
    turns_agree,
)
from cellctl.calibration.unit_slips import written_in_radians
from cellctl.errors.calibration import PosesNotDiverse, RobotCameraMismatch
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose

_OUTLIER_CHI2 = 40.0
"""Squared normalised residual (6 coordinates) of a pose with a gross error: p below 1e-6."""
_LEAST_KEPT = 0.8
"""Share of the poses. With more gross errors nobody knows which poses are the good ones."""
_MAX_START = 0.04
"""Distance by which the closed form may leave the board off its place, as a share of its distance.
More comes only from data of another setup, or of a board of another size."""


def calibrate_hand_eye(
    poses: Sequence[HandEyePose],
    setup: Setup,
    *,
    noise: RobotNoise | None = None,
    limits: HandEyeLimits | None = None,
) -> HandEyeResult:
    """Solve for camera and board. Raises ``PosesNotDiverse`` or ``RobotCameraMismatch``."""
    noise, limits = noise or RobotNoise(), limits or HandEyeLimits()
    used, rejected = _turning_alike(poses, setup)
    x, z, spread = _start(used, setup)
    while True:
        solution = adjust_hand_eye(used, setup, noise, x, z)
        x, z, squares = solution.x, solution.z, solution.squares
        worst = int(np.argmax(squares))
        # 5.35 is the median of a chi square with six degrees of freedom.
        typical = max(1.0, float(np.median(squares)) / 5.35)
        spare = len(used) > max(MIN_POSES, _LEAST_KEPT * len(poses))
        if squares[worst] <= _OUTLIER_CHI2 * typical or not spare:
            break
        # One at a time: a gross error pulls the solution and makes good poses look bad.
        rejected.append(used.pop(worst).name)
    residuals = {pose.name: _distance(pose, setup, x, z) for pose in poses}
    kept = np.array([residuals[pose.name] for pose in used])
    camera = UncertainPose(x, solution.covariance[:6, :6])
    board = UncertainPose(z, solution.covariance[6:, 6:])
    scale = board_scale(used, setup)
    mounting = mounting_check(setup, camera, board)
    return HandEyeResult(
        setup=setup,
        camera=camera,
        board=board,
        residuals=residuals,
        rejected=tuple(rejected),
        chi2_ratio=solution.chi2_ratio,
        spread_rad=(float(spread[0]), float(spread[1]), float(spread[2])),
        checks=(*limits.checks(camera, kept, solution.stated, scale), mounting),
        warnings=(
            *all_inverted(setup, mounting),
            *_warnings(rejected, solution.chi2_ratio),
            *another_size(*scale),
            *odd_poses(poses, rejected, lambda pose: _predicted(pose, setup, x, z)),
        ),
    )


def _turning_alike(
    poses: Sequence[HandEyePose], setup: Setup
) -> tuple[list[HandEyePose], list[str]]:
    """Poses without those that no closed form should see, and the names of these."""
    turns = [setup.turn(pose.base_T_flange) for pose in poses]
    agree = turns_agree(turns, [pose.camera_T_board.pose for pose in poses])
    if agree.sum() < max(MIN_POSES, _LEAST_KEPT * len(poses)):
        return list(poses), []
    return list(compress(poses, agree)), [pose.name for pose in compress(poses, ~agree)]


def _start(
    poses: Sequence[HandEyePose], setup: Setup
) -> tuple[RigidTransform, RigidTransform, Array]:
    """Closed form; names the mistake, if one explains why the data do not fit."""
    try:
        x, z, spread = _closed_form(poses, setup)
    except (RobotCameraMismatch, PosesNotDiverse) as fault:
        hint = explanation(poses, setup) if len(poses) >= MIN_POSES else None
        if hint is None and isinstance(fault, PosesNotDiverse) and _small_turns(poses):
            raise PosesNotDiverse(
                f"{fault.detail}; are the angles of robot and board written in radians?"
            ) from fault
        if hint is None:
            raise
        raise RobotCameraMismatch(f"{fault.detail}; {hint}") from fault
    # The closed form always yields something. The distance of the board tells whether the data fit
    # the setup.
    distance_m = _typical_distance(poses, setup, x, z)
    if distance_m > _MAX_START * board_distance_m(poses):
        hint = explanation(poses, setup)
        said = f"the board is off by {distance_m / MM:.0f} mm in the setup {setup.value}"
        raise RobotCameraMismatch(f"{said}; {hint}" if hint else said)
    return x, z, spread


def _small_turns(poses: Sequence[HandEyePose]) -> bool:
    """Both in radians fit each other, as turns that are nearly none."""
    return written_in_radians([pose.base_T_flange for pose in poses]) and written_in_radians(
        [pose.camera_T_board.pose for pose in poses]
    )


def _closed_form(
    poses: Sequence[HandEyePose], setup: Setup
) -> tuple[RigidTransform, RigidTransform, Array]:
    turns = [setup.turn(pose.base_T_flange) for pose in poses]
    return closed_form(turns, [pose.camera_T_board.pose for pose in poses])


def _predicted(
    pose: HandEyePose, setup: Setup, x: RigidTransform, z: RigidTransform
) -> RigidTransform:
    """camera_T_board."""
    return x.inv() * setup.turn(pose.base_T_flange).inv() * z


def _distance(
    pose: HandEyePose, setup: Setup, x: RigidTransform, z: RigidTransform
) -> tuple[float, float]:
    residual = residuals_of([pose], setup, x, z)[0]
    return float(np.linalg.norm(residual[:3])), float(np.linalg.norm(residual[3:]))


def _typical_distance(
    poses: Sequence[HandEyePose], setup: Setup, x: RigidTransform, z: RigidTransform
) -> float:
    return float(np.median(np.linalg.norm(residuals_of(poses, setup, x, z)[:, :3], axis=1)))


def _warnings(rejected: Sequence[str], chi2_ratio: float) -> tuple[str, ...]:
    warnings = []
    if rejected:
        warnings.append(f"poses left out as gross errors: {', '.join(rejected)}")
    # Squares: beyond twice the stated noise.
    if chi2_ratio > 4:
        warnings.append(
            f"residuals are {np.sqrt(chi2_ratio):.1f} times the stated noise of robot and camera"
        )
    return tuple(warnings)
