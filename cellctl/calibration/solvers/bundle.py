"""Joint adjustment of what all views of a calibration share, with a pose of the board per view.

Minimises the weighted reprojection error by Levenberg–Marquardt on normal equations from which
the board poses are eliminated (Schur complement). What the views share, and how many images a view
has, is the problem's: one camera, or the two of a head.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from cellctl.calibration.boards.projection import Projection
from cellctl.calibration.solvers.view_weights import weigh_views
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skews

_MAX_STEPS = 5000
"""Far more than any adjustment needs. A view that fits nothing is moved for hundreds of steps."""
_ROUNDS = 3
ROUGH, FINE = 1e-3, 1e-9
"""Relative gain of cost of one step at which an adjustment ends. A rough one serves where only the
size of residuals counts. With corners that fit nothing the last digits cost hundreds of steps."""
_HUBER = 4.0
"""Residual norm in sigmas per axis beyond which a corner loses weight. Of corners with normal noise
three in ten thousand lie farther out, exp(-4² / 2)."""


@dataclass(frozen=True, slots=True, eq=False)
class LinearImage:
    """Residuals of one image and the derivatives of its projection."""

    residuals: Array
    """Measured minus projected, px, shape (n, 2)."""
    by_shared: Array
    """Shape (n, 2, s)."""
    by_view: Array
    """Derivative by shift (m) and turn (rad) of the board in the camera frame, shape (n, 2, 6)."""


S = TypeVar("S")


class BundleProblem(Protocol[S]):
    """What is adjusted, for unknowns of type ``S``."""

    @property
    def name(self) -> str:
        """Name of the adjustment in messages, such as "stereo"."""

    @property
    def prior(self) -> Array:
        """Inverse prior variance of each shared unknown, 0 where it is free, shape (s,)."""

    def offsets(self, state: S) -> Array:
        """Shared unknowns less what the prior expects of them, shape (s,); 0 where free."""

    def linearise(self, state: S) -> Sequence[Sequence[LinearImage]]:
        """Per view, its images."""

    def moved(self, state: S, shared: Array, views: Array) -> S:
        """The unknowns after a step: ``shared`` of shape (s,), ``views`` of shape (views, 6)."""


@dataclass(frozen=True, slots=True, eq=False)
class BundleResult(Generic[S]):
    """The adjusted unknowns."""

    state: S
    residuals: tuple[tuple[Array, ...], ...]
    """Per view and image, measured minus projected, px, shape (n, 2)."""
    sigma_px: float
    """Standard deviation of a pixel coordinate from the residuals."""
    covariance: Array
    """Covariance of the shared unknowns, shape (s, s), from how the views disagree
    (``view_weights``)."""
    shift_sigmas: Array
    """How much the shared unknowns move when each view is left out: root mean square in stated
    standard deviations, shape (views,)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    """Normal equations by view, so that the poses can be eliminated and views weighed."""

    prior: Array
    """Inverse prior variance of each shared unknown, shape (s,)."""
    prior_gradient: Array
    shared: Array
    """Shape (views, s, s)."""
    mixed: Array
    """Shape (views, s, 6)."""
    own: Array
    """Shape (views, 6, 6)."""
    shared_gradient: Array
    """Shape (views, s)."""
    own_gradient: Array
    """Shape (views, 6)."""
    cost: float


def adjust_bundle(problem: BundleProblem[S], start: S, tolerance: float = FINE) -> BundleResult[S]:
    """Adjust from a start near the solution; raises ``SolveFailed``."""
    state, sigma_px = start, 1.0
    # Robust weights need the noise, and the noise needs the residuals: some rounds settle both.
    for number in range(_ROUNDS):
        sigma_px = _robust_sigma(residuals_of(problem, state))
        state = _minimise(problem, state, sigma_px, tolerance if number == _ROUNDS - 1 else ROUGH)
    residuals = residuals_of(problem, state)
    squares = sum(float((r**2).sum()) for images in residuals for r in images)
    count = sum(r.size for images in residuals for r in images)
    freedom = count - len(problem.prior) - 6 * len(residuals)
    sigma_px = float(np.sqrt(squares / max(freedom, 1)))
    # Once more without damping and with the final noise.
    information, pulls = _by_view(_normal_equations(problem, state, sigma_px), problem.name)
    weighed = weigh_views(problem.prior, information, pulls, problem.name)
    return BundleResult(state, residuals, sigma_px, weighed.covariance, weighed.shift_sigmas)


def place_board(problem: BundleProblem[S], start: S, sigma_px: float) -> S:
    """The best pose of the board while everything that views share is held; for a single view."""
    return _minimise(problem, start, sigma_px, ROUGH, poses_only=True)


def by_board_pose(projection: Projection, turned_m: Array) -> Array:
    """Derivative of a projection by the board's pose, shape (n, 2, 6).

    ``turned_m``, shape (n, 3), are the points turned into the camera frame but not yet shifted:
    small rotations go to the left of the present one.
    """
    return np.concatenate([projection.by_point, -projection.by_point @ skews(turned_m)], axis=2)


def residuals_of(problem: BundleProblem[S], state: S) -> tuple[tuple[Array, ...], ...]:
    """Per view and image, measured minus projected, px, shape (n, 2)."""
    return tuple(
        tuple(linear.residuals for linear in images) for images in problem.linearise(state)
    )


def residual_norms(residuals: Sequence[tuple[Array, ...]]) -> list[Array]:
    """Length of the residual of every corner, per view, image after image."""
    return [np.linalg.norm(np.concatenate(images), axis=1) for images in residuals]


def _minimise(
    problem: BundleProblem[S],
    state: S,
    sigma_px: float,
    tolerance: float,
    *,
    poses_only: bool = False,
) -> S:
    # Marquardt's rule: a tenth of the damping after a step that helped, ten times after one that
    # did not. It begins low, since the start is near the solution.
    damping = 1e-4
    normal = _normal_equations(problem, state, sigma_px)
    for _ in range(_MAX_STEPS):
        if poses_only:
            views = _own_step(normal, damping, problem.name)
            shared = np.zeros(len(problem.prior))
        else:
            shared, views = _step(normal, damping, problem.name)
        candidate = problem.moved(state, shared, views)
        trial = _normal_equations(problem, candidate, sigma_px)
        if trial.cost <= normal.cost:
            gain = normal.cost - trial.cost
            state, normal = candidate, trial
            damping = max(damping / 10, 1e-12)
            if gain <= tolerance * normal.cost:
                return state
        else:
            damping *= 10
            # No step lowers the cost, however short: this is the minimum within rounding.
            if damping > 1e6:
                return state
    raise SolveFailed(f"no convergence in {_MAX_STEPS} steps of the {problem.name} adjustment")


def _normal_equations(problem: BundleProblem[S], state: S, sigma_px: float) -> _Normal:
    views = problem.linearise(state)
    prior, offsets = problem.prior, problem.offsets(state)
    size, cost = len(prior), float((prior * offsets**2).sum())
    shared, gradient = np.zeros((len(views), size, size)), np.zeros((len(views), size))
    mixed = np.zeros((len(views), size, 6))
    own, own_gradient = np.zeros((len(views), 6, 6)), np.zeros((len(views), 6))
    for index, images in enumerate(views):
        for linear in images:
            weight, loss = _huber(linear.residuals / sigma_px)
            # One weight for both coordinates of a corner: a corner is hidden or blurred as a whole.
            scale = np.sqrt(weight)[:, None, None] / sigma_px
            by_shared = (linear.by_shared * scale).reshape(-1, size)
            by_view = (linear.by_view * scale).reshape(-1, 6)
            residuals = (linear.residuals * scale[:, :, 0]).ravel()
            shared[index] += by_shared.T @ by_shared
            gradient[index] += by_shared.T @ residuals
            mixed[index] += by_shared.T @ by_view
            own[index] += by_view.T @ by_view
            own_gradient[index] += by_view.T @ residuals
            cost += loss
    return _Normal(prior, -prior * offsets, shared, mixed, own, gradient, own_gradient, cost)


def _step(normal: _Normal, damping: float, name: str) -> tuple[Array, Array]:
    """Steps of the shared unknowns, shape (s,), and of the poses, shape (views, 6)."""
    reduced, gradient = _eliminate(normal, damping, name)
    delta: Array = cho_solve(_factor(reduced, name), gradient)
    rest = normal.own_gradient - np.einsum("vsk,s->vk", normal.mixed, delta)
    return delta, _solved(_damped(normal.own, damping), rest[:, :, None], name)[:, :, 0]


def _own_step(normal: _Normal, damping: float, name: str) -> Array:
    """Steps of the poses alone, shape (views, 6)."""
    own = _damped(normal.own, damping)
    return _solved(own, normal.own_gradient[:, :, None], name)[:, :, 0]


def _solved(matrices: Array, sides: Array, name: str) -> Array:
    """Of each view, shape (views, 6, n)."""
    try:
        return np.asarray(np.linalg.solve(matrices, sides))
    except np.linalg.LinAlgError as error:
        # Corners on one line, for example: the board may be turned about it.
        text = f"the {name} adjustment is singular: a view does not say how its board lies"
        raise SolveFailed(text) from error


def _eliminate(normal: _Normal, damping: float, name: str) -> tuple[Array, Array]:
    """Normal equations of the shared unknowns alone."""
    # The pose of a view occurs in its own images only, so each is eliminated by itself and the
    # cost grows linearly with the number of views.
    solved = _solved(_damped(normal.own, damping), normal.mixed.transpose(0, 2, 1), name)
    shared = np.diag(normal.prior) + normal.shared.sum(axis=0)
    reduced = _damped(shared, damping) - np.einsum("vsk,vkt->st", normal.mixed, solved)
    gradient = normal.prior_gradient + normal.shared_gradient.sum(axis=0)
    return reduced, gradient - np.einsum("vks,vk->s", solved, normal.own_gradient)


def _by_view(normal: _Normal, name: str) -> tuple[Array, Array]:
    """What each view says of the shared unknowns: information (v, s, s) and pull (v, s)."""
    solved = _solved(normal.own, normal.mixed.transpose(0, 2, 1), name)
    information = normal.shared - np.einsum("vsk,vkt->vst", normal.mixed, solved)
    pulls = normal.shared_gradient - np.einsum("vks,vk->vs", solved, normal.own_gradient)
    return information, pulls


def _damped(matrices: Array, damping: float) -> Array:
    # Marquardt: a share of the diagonal, so that pixels, metres and radians are damped alike.
    damped = matrices.copy()
    diagonal = np.einsum("...ii->...i", damped)
    diagonal *= 1 + damping
    return damped


def _factor(matrix: Array, name: str) -> tuple[Array, bool]:
    try:
        return cho_factor(matrix)
    except np.linalg.LinAlgError as error:
        raise SolveFailed(f"the {name} adjustment is singular") from error


def _huber(scaled: Array) -> tuple[Array, float]:
    """Weight of each corner and the robust cost."""
    norm = np.linalg.norm(scaled, axis=1)
    weight = np.minimum(1.0, _HUBER / np.maximum(norm, 1e-12))
    loss = np.where(norm <= _HUBER, norm**2, 2 * _HUBER * norm - _HUBER**2)
    return weight, float(loss.sum())


def _robust_sigma(residuals: Sequence[tuple[Array, ...]]) -> float:
    """Standard deviation of a coordinate from the median; never below a thousandth of a pixel."""
    # Half of a normal distribution lies within 0.6745 sigma. The floor: residuals of computed
    # images may be zero, and everything is divided by this.
    values = np.concatenate([np.abs(r).ravel() for images in residuals for r in images])
    return max(float(np.median(values)) / 0.6745, 1e-3)
