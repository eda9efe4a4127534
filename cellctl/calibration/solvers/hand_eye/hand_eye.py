"""Hand-eye calibration: AX = XB (eye in hand) and CG = GD (eye to hand).

A closed form starts a weighted maximum-likelihood solution: each pose's residual is weighted with
the covariance of the camera's pose and of the robot's pose. Measured against every closed form
and against pure reprojection, this is best or near best whatever the robot's accuracy
(docs/calibration.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.calibration.solvers.adjustment import Adjustment, weighted_least_squares
from cellctl.calibration.solvers.hand_eye.hand_eye_mistakes import explanation, odd_poses
from cellctl.calibration.solvers.hand_eye.hand_eye_result import (
    HandEyePose,
    HandEyeResult,
    RobotNoise,
    Setup,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_start import (
    MIN_POSES,
    closed_form,
    turns_agree,
)
from cellctl.errors.calibration import PosesNotDiverse, RobotCameraMismatch
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose, perturbed

_OUTLIER_CHI2 = 40.0
"""Squared normalised residual (6 coordinates) of a pose with a gross error: p below 1e-6."""
_LEAST_KEPT = 0.8
"""Share of the poses. With more gross errors nobody knows which poses are the good ones."""
_MAX_START_M = 0.02
"""The closed form puts the board this far off its place only with data of another setup."""


@dataclass(frozen=True, slots=True)
class HandEyeLimits:
    """Limits of the result."""

    poses: int = 8
    rms_m: float = 3e-4
    rms_rad: float = float(np.radians(0.05))
    position_sigma_m: float = 1e-4
    rotation_sigma_rad: float = float(np.radians(0.01))


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
        solution, x, z = _maximum_likelihood(used, setup, noise, x, z)
        squares = _pose_squares(used, setup, noise, x, z)
        worst = int(np.argmax(squares))
        # 5.35 is the median of a chi square with six degrees of freedom.
        typical = max(1.0, float(np.median(squares)) / 5.35)
        spare = len(used) > max(MIN_POSES, _LEAST_KEPT * len(poses))
        if squares[worst] <= _OUTLIER_CHI2 * typical or not spare:
            break
        rejected.append(used.pop(worst).name)
    residuals = {pose.name: _distance(pose, setup, x, z) for pose in poses}
    kept = np.array([residuals[pose.name] for pose in used])
    camera = UncertainPose(x, solution.covariance[:6, :6])
    return HandEyeResult(
        setup=setup,
        camera=camera,
        board=UncertainPose(z, solution.covariance[6:, 6:]),
        residuals=residuals,
        rejected=tuple(rejected),
        chi2_ratio=solution.chi2_ratio,
        spread_rad=(float(spread[0]), float(spread[1]), float(spread[2])),
        checks=_checks(camera, kept, limits),
        warnings=(
            *_warnings(rejected, solution.chi2_ratio),
            *odd_poses(poses, rejected, lambda pose: _predicted(pose, setup, x, z)),
        ),
    )


def _turning_alike(
    poses: Sequence[HandEyePose], setup: Setup
) -> tuple[list[HandEyePose], list[str]]:
    """Poses without those that no closed form should see, and the names of these."""
    turns = [_turn(pose.base_T_flange, setup) for pose in poses]
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
        if hint is None:
            raise
        raise RobotCameraMismatch(f"{fault.detail}; {hint}") from fault
    # The closed form always yields something. The distance of the board tells whether the data fit
    # the setup.
    distance_m = _typical_distance(poses, setup, x, z)
    if distance_m > _MAX_START_M:
        hint = explanation(poses, setup)
        said = f"the board is off by {distance_m / MM:.0f} mm in the setup {setup.value}"
        raise RobotCameraMismatch(f"{said}; {hint}" if hint else said)
    return x, z, spread


def _closed_form(
    poses: Sequence[HandEyePose], setup: Setup
) -> tuple[RigidTransform, RigidTransform, Array]:
    turns = [_turn(pose.base_T_flange, setup) for pose in poses]
    return closed_form(turns, [pose.camera_T_board.pose for pose in poses])


def _maximum_likelihood(
    poses: Sequence[HandEyePose],
    setup: Setup,
    noise: RobotNoise,
    x: RigidTransform,
    z: RigidTransform,
) -> tuple[Adjustment, RigidTransform, RigidTransform]:
    """Two rounds, because the weights depend a little on X and Z."""
    back_turns, measured = _stacked(poses, setup)
    for _ in range(2):
        whitening = _whitening(poses, setup, noise, x, z)
        x_0, z_0 = x, z

        def residuals(delta: Array) -> Array:
            x_1, z_1 = perturbed(x_0, delta[:6]), perturbed(z_0, delta[6:])  # noqa: B023
            raw = _compare(back_turns, measured, x_1, z_1)
            return np.asarray(np.einsum("nij,nj->ni", whitening, raw).ravel())  # noqa: B023

        solution = weighted_least_squares(residuals, np.zeros(12))
        x, z = perturbed(x, solution.parameters[:6]), perturbed(z, solution.parameters[6:])
    return solution, x, z


def _residuals(
    poses: Sequence[HandEyePose], setup: Setup, x: RigidTransform, z: RigidTransform
) -> Array:
    """Measured against predicted camera_T_board, shape (n, 6)."""
    return _compare(*_stacked(poses, setup), x, z)


def _stacked(poses: Sequence[HandEyePose], setup: Setup) -> tuple[RigidTransform, RigidTransform]:
    """All turns, inverted, and all measured camera_T_board."""
    turns = [_turn(pose.base_T_flange, setup).inv() for pose in poses]
    return RigidTransform.concatenate(turns), RigidTransform.concatenate(
        [pose.camera_T_board.pose for pose in poses]
    )


def _compare(
    back_turns: RigidTransform, measured: RigidTransform, x: RigidTransform, z: RigidTransform
) -> Array:
    predicted = x.inv() * back_turns * z
    turn = (measured.rotation * predicted.rotation.inv()).as_rotvec()
    return np.concatenate([measured.translation - predicted.translation, turn], axis=1)


def _whitening(
    poses: Sequence[HandEyePose],
    setup: Setup,
    noise: RobotNoise,
    x: RigidTransform,
    z: RigidTransform,
) -> Array:
    """Inverse Cholesky factors of the residuals' covariances, shape (n, 6, 6)."""
    back, board = UncertainPose.exact(x.inv()), UncertainPose.exact(z)
    factors = []
    for pose in poses:
        robot = UncertainPose(pose.base_T_flange, noise.covariance)
        # The robot's noise is stated in the base. Where the inverse pose enters, its covariance
        # must be carried along, or position and rotation noise would not mix as they do.
        turn = robot if setup is Setup.EYE_IN_HAND else robot.inv()
        predicted = back * turn.inv() * board
        total = predicted.covariance + pose.camera_T_board.covariance
        factors.append(np.linalg.inv(np.linalg.cholesky(total)))
    return np.stack(factors)


def _pose_squares(
    poses: Sequence[HandEyePose],
    setup: Setup,
    noise: RobotNoise,
    x: RigidTransform,
    z: RigidTransform,
) -> Array:
    raw = _residuals(poses, setup, x, z)
    white = np.einsum("nij,nj->ni", _whitening(poses, setup, noise, x, z), raw)
    return np.asarray((white**2).sum(axis=1))


def _turn(base_T_flange: RigidTransform, setup: Setup) -> RigidTransform:
    return base_T_flange if setup is Setup.EYE_IN_HAND else base_T_flange.inv()


def _predicted(
    pose: HandEyePose, setup: Setup, x: RigidTransform, z: RigidTransform
) -> RigidTransform:
    """camera_T_board."""
    return x.inv() * _turn(pose.base_T_flange, setup).inv() * z


def _distance(
    pose: HandEyePose, setup: Setup, x: RigidTransform, z: RigidTransform
) -> tuple[float, float]:
    residual = _residuals([pose], setup, x, z)[0]
    return float(np.linalg.norm(residual[:3])), float(np.linalg.norm(residual[3:]))


def _typical_distance(
    poses: Sequence[HandEyePose], setup: Setup, x: RigidTransform, z: RigidTransform
) -> float:
    return float(np.median(np.linalg.norm(_residuals(poses, setup, x, z)[:, :3], axis=1)))


def _checks(camera: UncertainPose, kept: Array, limits: HandEyeLimits) -> Checks:
    rms_m, rms_rad = np.sqrt((kept**2).mean(axis=0))
    sigma = camera.sigma
    degrees = np.degrees
    return (
        LimitCheck("poses", len(kept), limits.poses, "", "min"),
        LimitCheck("residual rms", rms_m / MM, limits.rms_m / MM, "mm"),
        LimitCheck("residual rms", degrees(rms_rad), float(degrees(limits.rms_rad)), "°"),
        LimitCheck("position sigma", sigma[:3].max() / MM, limits.position_sigma_m / MM, "mm"),
        LimitCheck(
            "rotation sigma",
            degrees(sigma[3:].max()),
            float(degrees(limits.rotation_sigma_rad)),
            "°",
        ),
    )


def _warnings(rejected: Sequence[str], chi2_ratio: float) -> tuple[str, ...]:
    warnings = []
    if rejected:
        warnings.append(f"poses left out as gross errors: {', '.join(rejected)}")
    if chi2_ratio > 4:
        warnings.append(
            f"residuals are {np.sqrt(chi2_ratio):.1f} times the stated noise of robot and camera"
        )
    return tuple(warnings)
