"""Maximum-likelihood hand-eye solution whose weights the residuals themselves correct.

How much robot and camera scatter is stated by a data sheet and by a model of noise, and both are
often wrong by a factor. A common factor would not matter; wrong proportions between the robot's
positions, its angles and the camera's poses do: with few poses such weights can do worse than a
closed form, which has none. So the three scales are unknowns beside camera and board, held
loosely at what is stated and found by restricted maximum likelihood (Patterson and Thompson 1971,
which allows for what the solution itself takes out of the residuals). Poses far off lose weight
(Student's t): poses of a robot have more large errors than a normal distribution.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, RobotNoise, Setup
from cellctl.errors.calibration import IllConditioned, SolveFailed
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import inverse_jacobian, perturbed, skews

_SCALE_SIGMA = 1.0
"""Standard deviation of the logarithm of each scale: what is stated is good to a factor of e."""
_FREEDOM = 30.0
"""Degrees of freedom of Student's distribution, which the errors of the poses are taken from."""
_STEP, _MOST_STEPS = 2.0**0.5, 12
"""Scales are found in steps of this factor: finer ones move the solution by far less than it is
uncertain by, and the coarse ones make the result the same to the last digit for any order of the
poses."""
_SEARCH_ROUNDS = 12
"""Rounds after which the scales stay as they are: two neighbouring values could take turns for
ever."""
_MOST_ROUNDS = 100
_SETTLED = 1e-7
"""Largest step that is left, in standard deviations of what is solved for."""
_MAX_CONDITION = 1e12
"""Condition number beyond which no digit of the covariance is right."""

Steps = tuple[int, ...]
"""Logarithms of the scales of robot positions, robot angles and camera, in steps."""


@dataclass(frozen=True, slots=True)
class NoiseScales:
    """Multiples of the stated standard deviations."""

    robot_position: float = 1.0
    robot_rotation: float = 1.0
    camera: float = 1.0

    @classmethod
    def of(cls, steps: Steps) -> "NoiseScales":
        """From whole steps."""
        return cls(*(_STEP**step for step in steps))


@dataclass(frozen=True, slots=True, eq=False)
class HandEyeAdjustment:
    """Camera and board at the optimum."""

    x: RigidTransform
    z: RigidTransform
    covariance: Array
    """Covariance of X, then of Z, shape (12, 12)."""
    chi2_ratio: float
    """Squares in units of the stated noise over their expectation."""
    squares: Array
    """Square of each pose's residual in units of the noise that was found, shape (n,)."""
    scales: NoiseScales
    stated: tuple[float, float]
    """Expected rms distance (m) and angle (rad) of the board by the stated noise."""


@dataclass(frozen=True, slots=True, eq=False)
class _Linearised:
    """Residuals of all poses at X and Z."""

    raw: Array
    """Measured against predicted camera_T_board, shape (n, 6)."""
    design: Array
    """Derivative of the residuals by the twelve unknowns, shape (n, 6, 12)."""
    parts: Array
    """Stated covariance that robot positions, robot angles and camera add, shape (3, n, 6, 6)."""

    def covariances(self, scales: NoiseScales) -> Array:
        """Shape (n, 6, 6)."""
        factors = (scales.robot_position, scales.robot_rotation, scales.camera)
        return np.asarray(np.tensordot(np.square(factors), self.parts, axes=1))


def residuals_of(
    poses: Sequence[HandEyePose], setup: Setup, x: RigidTransform, z: RigidTransform
) -> Array:
    """Measured against predicted camera_T_board: m and rad in the camera's axes, shape (n, 6)."""
    back = RigidTransform.concatenate([setup.turn(pose.base_T_flange).inv() for pose in poses])
    measured = RigidTransform.concatenate([pose.camera_T_board.pose for pose in poses])
    predicted = x.inv() * back * z
    turn = (measured.rotation * predicted.rotation.inv()).as_rotvec()
    return np.concatenate([measured.translation - predicted.translation, turn], axis=1)


def adjust_hand_eye(
    poses: Sequence[HandEyePose],
    setup: Setup,
    noise: RobotNoise,
    x: RigidTransform,
    z: RigidTransform,
) -> HandEyeAdjustment:
    """From a start near the optimum; raises ``SolveFailed`` or ``IllConditioned``."""
    steps: Steps = (0, 0, 0)
    shares = np.ones(len(poses))
    for number in range(_MOST_ROUNDS):
        here = _linearised(poses, setup, noise, x, z)
        if number < _SEARCH_ROUNDS:
            steps = _likeliest_scales(here, shares, steps)
        inverses = np.linalg.inv(here.covariances(NoiseScales.of(steps)))
        step, normal = _step(here, inverses * shares[:, None, None])
        x, z = perturbed(x, step[:6]), perturbed(z, step[6:])
        left = here.raw + here.design @ step
        squares = np.einsum("ni,nij,nj->n", left, inverses, left)
        before, shares = shares, (_FREEDOM + 6.0) / (_FREEDOM + squares)
        moved = float(np.sqrt(step @ normal @ step))
        if moved < _SETTLED and np.abs(shares - before).max() < _SETTLED:
            break
    else:
        raise SolveFailed(f"hand-eye: no optimum after {_MOST_ROUNDS} rounds")
    here, scales = _linearised(poses, setup, noise, x, z), NoiseScales.of(steps)
    stated = _squares(here, NoiseScales())
    freedom = max(6 * len(poses) - 12, 1)
    return HandEyeAdjustment(
        x,
        z,
        _covariance(here, shares, scales),
        float(stated.sum()) / freedom,
        _squares(here, scales),
        scales,
        _expected(here),
    )


def _linearised(
    poses: Sequence[HandEyePose],
    setup: Setup,
    noise: RobotNoise,
    x: RigidTransform,
    z: RigidTransform,
) -> _Linearised:
    turn = RigidTransform.concatenate([setup.turn(pose.base_T_flange) for pose in poses])
    back_x, back = x.inv(), turn.inv()
    # Predicted is x^-1 · turn^-1 · z: how small errors of each factor change the product.
    by_back_x = _by_first(back_x, back * z) @ inverse_jacobian(x)
    by_z = _by_second(back_x * back)
    by_turn = _by_first(back_x * back, z) @ _by_second(back_x)
    # Errors are stated in the base. Where the inverse pose enters they are carried along, or
    # errors of position and angle would not mix as they do.
    if setup is Setup.EYE_IN_HAND:
        turned = _by_second(back)
        turned[:, :3, 3:] = turned[:, :3, :3] @ skews(turn.translation)
        by_turn = by_turn @ -turned
    position, rotation = by_turn[:, :, :3], by_turn[:, :, 3:]
    parts = (
        noise.position_m**2 * position @ position.transpose(0, 2, 1),
        noise.rotation_rad**2 * rotation @ rotation.transpose(0, 2, 1),
        np.stack([pose.camera_T_board.covariance for pose in poses]),
    )
    design = -np.concatenate([by_back_x, by_z], axis=2)
    return _Linearised(residuals_of(poses, setup, x, z), design, np.stack(parts))


def _by_first(first: RigidTransform, second: RigidTransform) -> Array:
    """Derivative of products by their first factor: ``product_jacobians`` for many poses at
    once."""
    arms = np.atleast_2d((first * second).translation - first.translation)
    jacobians = np.tile(np.eye(6), (len(arms), 1, 1))
    jacobians[:, :3, 3:] = -skews(arms)
    return jacobians


def _by_second(first: RigidTransform) -> Array:
    """Derivative of products by their second factor, which only the rotation of the first one
    turns."""
    rotations = first.rotation.as_matrix().reshape(-1, 3, 3)
    jacobians = np.zeros((len(rotations), 6, 6))
    jacobians[:, :3, :3] = jacobians[:, 3:, 3:] = rotations
    return jacobians


def _step(here: _Linearised, weights: Array) -> tuple[Array, Array]:
    """The step to the optimum and the normal matrix; ``weights`` of shape (n, 6, 6)."""
    weighted = weights @ here.design
    normal = np.einsum("nij,nik->jk", here.design, weighted)
    scale = np.sqrt(np.diag(normal))
    if not scale.all() or np.linalg.cond(normal / np.outer(scale, scale)) > _MAX_CONDITION:
        raise IllConditioned("some unknown has no influence on the data")
    gradient = np.einsum("nij,ni->j", weighted, here.raw)
    return -np.linalg.solve(normal / np.outer(scale, scale), gradient / scale) / scale, normal


def _likeliest_scales(here: _Linearised, shares: Array, start: Steps) -> Steps:
    """Restricted maximum likelihood of the scales, with their prior, in coarse steps.

    None falls below 1: residuals that scatter less than stated may be luck.
    """
    costs: dict[Steps, float] = {}

    def cost(steps: Steps) -> float:
        if steps not in costs:
            costs[steps] = _restricted_cost(here, shares, steps)
        return costs[steps]

    best = start
    while True:
        beside = [
            (*best[:index], best[index] + way, *best[index + 1 :])
            for index in range(len(best))
            for way in (-1, 1)
            if 0 <= best[index] + way <= _MOST_STEPS
        ]
        likeliest = min((best, *beside), key=cost)
        if likeliest == best:
            return best
        best = likeliest


def _restricted_cost(here: _Linearised, shares: Array, steps: Steps) -> float:
    """Minus twice the logarithm of the restricted likelihood and of the prior of the scales."""
    covariances = here.covariances(NoiseScales.of(steps))
    weights = np.linalg.inv(covariances) * shares[:, None, None]
    step, normal = _step(here, weights)
    left = here.raw + here.design @ step
    squares = np.einsum("ni,nij,nj->", left, weights, left)
    # Great scales make every square small: the determinant of the covariances is their price. That
    # of the normal matrix is what "restricted" adds, for the twelve unknowns that fit themselves
    # to the residuals.
    sizes = np.linalg.slogdet(covariances)[1].sum() + np.linalg.slogdet(normal)[1]
    prior = np.square(np.array(steps) * np.log(_STEP) / _SCALE_SIGMA).sum()
    return float(squares + sizes + prior)


def _expected(here: _Linearised) -> tuple[float, float]:
    """What the stated noise lets the board be off by: rms distance (m) and angle (rad)."""
    variances = np.diagonal(here.covariances(NoiseScales()), axis1=1, axis2=2).mean(axis=0)
    return float(np.sqrt(variances[:3].sum())), float(np.sqrt(variances[3:].sum()))


def _squares(here: _Linearised, scales: NoiseScales) -> Array:
    inverses = np.linalg.inv(here.covariances(scales))
    return np.asarray(np.einsum("ni,nij,nj->n", here.raw, inverses, here.raw))


def _covariance(here: _Linearised, shares: Array, scales: NoiseScales) -> Array:
    """Covariance of the solution that these weights give, for the noise that was found."""
    # The inverse of the normal matrix would do if the weights were the inverse of the noise. With
    # the shares of Student's distribution they are not: hence the product of three.
    errors = here.covariances(scales)
    weights = np.linalg.inv(errors) * shares[:, None, None]
    weighted = weights @ here.design
    back = np.linalg.inv(np.einsum("nij,nik->jk", here.design, weighted))
    middle = np.einsum("nji,njk,nkl->il", weighted, errors, weighted)
    return np.asarray(back @ middle @ back)
