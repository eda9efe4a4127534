"""Joint adjustment of both cameras, all board poses and the shape of the board.

Minimises the weighted reprojection error by Levenberg–Marquardt on normal equations from which
the board poses are eliminated (Schur complement). Unknowns that all views share, in order: the
24 of ``PARAMETER_ORDER``, then those of the board's shape.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, Corners, ShapeModes
from cellctl.calibration.boards.projection import project
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skews

_HEAD = 24
_MAX_STEPS = 60
_ROUNDS = 3
_HUBER = 4.0
"""Residual norm in sigmas per axis beyond which a corner loses weight."""


@dataclass(frozen=True, slots=True, eq=False)
class BundleState:
    """All unknowns."""

    left: Array
    """Nine numbers of ``CAMERA_PARAMETERS``."""
    right: Array
    rotation: Array
    """x_right = rotation @ x_left + translation_m."""
    translation_m: Array
    shape: Array
    """Parameters of the board's shape."""
    view_rotations: Array
    """left_R_board, shape (views, 3, 3)."""
    view_translations_m: Array
    """Shape (views, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class BundleResult:
    """The adjusted unknowns."""

    state: BundleState
    residuals: tuple[tuple[Array, Array], ...]
    """Per view: left (n, 2) and right (n, 2), measured minus projected, px."""
    sigma_px: float
    """Standard deviation of a pixel coordinate from the residuals."""
    covariance: Array
    """Covariance of the shared unknowns, shape (24 + shape, 24 + shape)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    shared: Array
    mixed: Array
    own: Array
    shared_gradient: Array
    own_gradient: Array
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class _Linear:
    """Residuals of one image and their derivatives."""

    residuals: Array
    by_shared: Array
    by_view: Array


def adjust(
    views: Sequence[BoardView], flat_m: Array, modes: ShapeModes, start: BundleState
) -> BundleResult:
    """Adjust from a start near the solution; raises ``SolveFailed``."""
    state, sigma_px = start, 1.0
    # Robust weights need the noise, and the noise needs the residuals: some rounds settle both.
    for _ in range(_ROUNDS):
        sigma_px = _robust_sigma(_all_residuals(views, flat_m, modes, state))
        state = _minimise(views, flat_m, modes, state, sigma_px)
    residuals = _all_residuals(views, flat_m, modes, state)
    squares = sum(float((r**2).sum()) for pair in residuals for r in pair)
    count = sum(r.size for pair in residuals for r in pair)
    freedom = count - _HEAD - len(modes.sigma) - 6 * len(views)
    sigma_px = float(np.sqrt(squares / max(freedom, 1)))
    # Once more without damping and with the final noise: this matrix is the covariance's inverse.
    normal = _normal_equations(views, flat_m, modes, state, sigma_px)
    reduced, _ = _eliminate(normal, 0.0)
    return BundleResult(state, residuals, sigma_px, _inverse(reduced))


def residual_norms(residuals: Sequence[tuple[Array, Array]]) -> list[Array]:
    """Length of the residual of every corner, per view, left then right."""
    return [np.linalg.norm(np.concatenate(pair), axis=1) for pair in residuals]


def _minimise(
    views: Sequence[BoardView],
    flat_m: Array,
    modes: ShapeModes,
    state: BundleState,
    sigma_px: float,
) -> BundleState:
    damping = 1e-4
    normal = _normal_equations(views, flat_m, modes, state, sigma_px)
    for _ in range(_MAX_STEPS):
        candidate = _step(state, normal, damping)
        trial = _normal_equations(views, flat_m, modes, candidate, sigma_px)
        if trial.cost <= normal.cost:
            gain = normal.cost - trial.cost
            state, normal = candidate, trial
            damping = max(damping / 10, 1e-12)
            if gain <= 1e-9 * normal.cost:
                return state
        else:
            damping *= 10
            # No step lowers the cost, however short: this is the minimum within rounding.
            if damping > 1e6:
                return state
    raise SolveFailed(f"no convergence in {_MAX_STEPS} steps of the stereo adjustment")


def _normal_equations(
    views: Sequence[BoardView],
    flat_m: Array,
    modes: ShapeModes,
    state: BundleState,
    sigma_px: float,
) -> _Normal:
    size = _HEAD + len(modes.sigma)
    shared, gradient = np.zeros((size, size)), np.zeros(size)
    prior = np.concatenate([np.zeros(_HEAD), 1 / modes.sigma**2])
    shared[np.diag_indices(size)] = prior
    gradient[_HEAD:] = -prior[_HEAD:] * state.shape
    cost = float((prior[_HEAD:] * state.shape**2).sum())
    mixed = np.zeros((len(views), size, 6))
    own, own_gradient = np.zeros((len(views), 6, 6)), np.zeros((len(views), 6))
    for index, view in enumerate(views):
        for corners, is_right in ((view.left, False), (view.right, True)):
            linear = _linearise(corners, flat_m, modes, state, index, is_right=is_right)
            weight, loss = _huber(linear.residuals / sigma_px)
            # One weight for both coordinates of a corner: a corner is hidden or blurred as a whole.
            scale = np.sqrt(weight)[:, None, None] / sigma_px
            by_shared = (linear.by_shared * scale).reshape(-1, size)
            by_view = (linear.by_view * scale).reshape(-1, 6)
            residuals = (linear.residuals * scale[:, :, 0]).ravel()
            shared += by_shared.T @ by_shared
            gradient += by_shared.T @ residuals
            mixed[index] += by_shared.T @ by_view
            own[index] += by_view.T @ by_view
            own_gradient[index] += by_view.T @ residuals
            cost += loss
    return _Normal(shared, mixed, own, gradient, own_gradient, cost)


def _linearise(
    corners: Corners,
    flat_m: Array,
    modes: ShapeModes,
    state: BundleState,
    index: int,
    *,
    is_right: bool,
) -> _Linear:
    """Residuals of one image; derivatives of the projection by shared and own unknowns."""
    shape = modes.modes[corners.ids]
    board_m = flat_m[corners.ids] + shape @ state.shape
    rotation = state.view_rotations[index]
    turned = board_m @ rotation.T
    in_left = turned + state.view_translations_m[index]
    by_shared = np.zeros((len(board_m), 2, _HEAD + shape.shape[2]))
    if is_right:
        moved = in_left @ state.rotation.T
        projection = project(state.right, moved + state.translation_m)
        by_left = projection.by_point @ state.rotation
        by_shared[:, :, 9:18] = projection.by_camera
        by_shared[:, :, 18:21] = -projection.by_point @ skews(moved)
        by_shared[:, :, 21:24] = projection.by_point
    else:
        projection = project(state.left, in_left)
        by_left = projection.by_point
        by_shared[:, :, :9] = projection.by_camera
    by_shared[:, :, _HEAD:] = by_left @ rotation @ shape
    by_view = np.concatenate([by_left, -by_left @ skews(turned)], axis=2)
    return _Linear(corners.pixels - projection.pixels, by_shared, by_view)


def _step(state: BundleState, normal: _Normal, damping: float) -> BundleState:
    reduced, gradient = _eliminate(normal, damping)
    delta = cho_solve(_factor(reduced), gradient)
    own = _damped(normal.own, damping)
    rest = normal.own_gradient - np.einsum("vsk,s->vk", normal.mixed, delta)
    view_delta = np.linalg.solve(own, rest[:, :, None])[:, :, 0]
    # Small rotations go to the left of the present ones: so the derivatives were taken.
    turns = Rotation.from_rotvec(view_delta[:, 3:]).as_matrix()
    return replace(
        state,
        left=state.left + delta[:9],
        right=state.right + delta[9:18],
        rotation=Rotation.from_rotvec(delta[18:21]).as_matrix() @ state.rotation,
        translation_m=state.translation_m + delta[21:24],
        shape=state.shape + delta[_HEAD:],
        view_rotations=turns @ state.view_rotations,
        view_translations_m=state.view_translations_m + view_delta[:, :3],
    )


def _eliminate(normal: _Normal, damping: float) -> tuple[Array, Array]:
    """Normal equations of the shared unknowns alone."""
    # The pose of a view occurs in its own two images only, so each is eliminated by itself and
    # the cost grows linearly with the number of views.
    solved = np.linalg.solve(_damped(normal.own, damping), normal.mixed.transpose(0, 2, 1))
    reduced = _damped(normal.shared, damping) - np.einsum("vsk,vkt->st", normal.mixed, solved)
    gradient = normal.shared_gradient - np.einsum("vks,vk->s", solved, normal.own_gradient)
    return reduced, gradient


def _damped(matrices: Array, damping: float) -> Array:
    # Marquardt: a share of the diagonal, so that pixels, metres and radians are damped alike.
    damped = matrices.copy()
    diagonal = np.einsum("...ii->...i", damped)
    diagonal *= 1 + damping
    return damped


def _factor(matrix: Array) -> tuple[Array, bool]:
    try:
        return cho_factor(matrix)
    except np.linalg.LinAlgError as error:
        raise SolveFailed("the stereo adjustment is singular") from error


def _inverse(matrix: Array) -> Array:
    """Inverse of a positive definite matrix with badly scaled unknowns."""
    scale = 1 / np.sqrt(np.diag(matrix))
    inverse: Array = cho_solve(_factor(matrix * np.outer(scale, scale)), np.eye(len(matrix)))
    return inverse * np.outer(scale, scale)


def _huber(scaled: Array) -> tuple[Array, float]:
    """Weight of each corner and the robust cost."""
    norm = np.linalg.norm(scaled, axis=1)
    weight = np.minimum(1.0, _HUBER / np.maximum(norm, 1e-12))
    loss = np.where(norm <= _HUBER, norm**2, 2 * _HUBER * norm - _HUBER**2)
    return weight, float(loss.sum())


def _robust_sigma(residuals: Sequence[tuple[Array, Array]]) -> float:
    """Standard deviation of a coordinate from the median; never below a thousandth of a pixel."""
    values = np.concatenate([np.abs(r).ravel() for pair in residuals for r in pair])
    return max(float(np.median(values)) / 0.6745, 1e-3)


def _all_residuals(
    views: Sequence[BoardView], flat_m: Array, modes: ShapeModes, state: BundleState
) -> tuple[tuple[Array, Array], ...]:
    pairs = []
    for index, view in enumerate(views):
        left = _linearise(view.left, flat_m, modes, state, index, is_right=False)
        right = _linearise(view.right, flat_m, modes, state, index, is_right=True)
        pairs.append((left.residuals, right.residuals))
    return tuple(pairs)
