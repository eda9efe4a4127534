"""The line of a robot axis from targets on the arm while that axis alone turns.

All targets and all stops are adjusted together. The commanded angles take part with their own
uncertainty, which makes short arcs far stronger than circles fitted on their own; each stop also
has a small displacement of the whole arm (its repeatability), common to its targets.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.spatial.transform import Rotation

from cellctl.calibration.solvers.adjustment import weighted_least_squares
from cellctl.errors.calibration import AxisMotionInvalid
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skew
from cellctl.interfaces.target_tracker import Target

Indices = NDArray[np.intp]

_STILL_RAD = 1e-4
"""The other joints hold their place within their encoders' noise."""
MIN_STOPS = 4
"""Stops of one axis. Three points always lie on a circle; the fourth shows whether these do."""


@dataclass(frozen=True, slots=True, eq=False)
class AxisStop:
    """The arm at rest: its joint angles and the targets that the large-field head sees."""

    joints_rad: Array
    """Shape (6,)."""
    targets: tuple[Target, ...]


@dataclass(frozen=True, slots=True)
class ArmNoise:
    """The errors of a stop besides the noise of the target measurement."""

    repeatability_m: float = 2e-5
    """Standard deviation of a coordinate of the arm's position at a stop."""
    angle_rad: float = 2e-5
    """Standard deviation of the turned angle against the reported one."""


@dataclass(frozen=True, slots=True, eq=False)
class AxisFit:
    """An axis in the frame of the head."""

    direction: Array
    """Unit vector, shape (3,); a positive joint angle turns about it."""
    point_m: Array
    """The point of the axis nearest to the middle of the targets."""
    covariance: Array
    """Shape (6, 6): direction, then point; both without the part along the axis."""
    residuals_m: Array
    """Measured minus adjusted, shape (n, 3)."""
    residual_names: tuple[str, ...]
    """Stop and target of each residual, for example ``3:F2``."""
    arc_rad: float
    targets: tuple[str, ...]
    radii_m: Array
    """Distance of each target from the axis."""
    chi2_ratio: float
    """Weighted squares over their expectation: 1 when the stated noise is right."""
    points_m: Array
    """Measured points, shape (n, 3), for the picture."""

    @property
    def rms_m(self) -> float:
        """Rms distance of a measured point from its adjusted place."""
        return float(np.sqrt((self.residuals_m**2).sum(axis=1).mean()))


@dataclass(frozen=True, slots=True, eq=False)
class _Observations:
    points: Array
    stop: Indices
    target: Indices
    sigma: Array
    angles: Array
    names: tuple[str, ...]


def fit_axis(stops: Sequence[AxisStop], joint: int, sign: int, noise: ArmNoise) -> AxisFit:
    """Fit the axis of ``joint`` (0 is A1); raises ``AxisMotionInvalid``.

    ``sign`` is +1 when a positive joint angle turns right-handed about the wanted direction.
    """
    angles = sign * _joint_angles(stops, joint)
    data = _observations(stops, angles)
    direction, middle, positions = _start(data)
    basis = perpendicular(direction)
    whitening = _whitening(data, direction, middle, noise)

    def axis(parameters: Array) -> tuple[Array, Array]:
        # Four numbers are all that a line has: its direction and its place can change across it
        # only. A fifth, along the line, would make the problem singular.
        turned = direction + parameters[:2] @ basis
        return turned / np.linalg.norm(turned), middle + parameters[2:4] @ basis

    def residuals(parameters: Array) -> Array:
        raw = data.points - _predict(data, *axis(parameters), parameters[4:].reshape(-1, 3))
        return np.concatenate(
            [solve_triangular(factor, raw[rows].ravel(), lower=True) for rows, factor in whitening]
        )

    start = np.concatenate([np.zeros(4), positions.ravel()])
    solution = weighted_least_squares(residuals, start)
    # Back from the two coordinates across the line to x, y, z; along it nothing is uncertain.
    four = solution.covariance[:4, :4]
    lift = np.zeros((6, 4))
    lift[:3, :2] = lift[3:, 2:] = basis.T
    unit, point = axis(solution.parameters)
    fitted = solution.parameters[4:].reshape(-1, 3)
    return AxisFit(
        direction=unit,
        point_m=point,
        covariance=lift @ four @ lift.T,
        residuals_m=data.points - _predict(data, unit, point, fitted),
        residual_names=data.names,
        arc_rad=float(np.ptp(angles)),
        targets=tuple(sorted({name.split(":", 1)[1] for name in data.names})),
        radii_m=np.linalg.norm(np.cross(fitted - point, unit), axis=1),
        chi2_ratio=solution.chi2_ratio,
        points_m=data.points,
    )


def _joint_angles(stops: Sequence[AxisStop], joint: int) -> Array:
    if len(stops) < MIN_STOPS:
        raise AxisMotionInvalid(f"A{joint + 1}: {len(stops)} stops, at least {MIN_STOPS} needed")
    joints = np.stack([stop.joints_rad for stop in stops])
    others = np.delete(np.ptp(joints, axis=0), joint)
    # Written so that a joint whose angle is not a number counts as moved.
    if not others.max() <= _STILL_RAD:
        moved = int(np.delete(np.arange(6), joint)[int(np.argmax(others))]) + 1
        raise AxisMotionInvalid(f"A{moved} moved by {np.degrees(others.max()):.3f}° too")
    return np.asarray(joints[:, joint], dtype=float)


def _observations(stops: Sequence[AxisStop], angles: Array) -> _Observations:
    seen = [target.name for stop in stops for target in stop.targets]
    # A target seen at few stops adds three unknowns and little else.
    kept = sorted({name for name in seen if seen.count(name) >= MIN_STOPS})
    if not kept:
        raise AxisMotionInvalid(f"no target was seen at {MIN_STOPS} stops or more")
    rows = [
        (index, kept.index(target.name), target)
        for index, stop in enumerate(stops)
        for target in stop.targets
        if target.name in kept
    ]
    return _Observations(
        points=np.stack([target.position_m for _, _, target in rows]).astype(float),
        stop=np.array([stop for stop, _, _ in rows]),
        target=np.array([number for _, number, _ in rows]),
        # A stated sigma of zero would give one target infinite weight.
        sigma=np.array([max(target.sigma_m, 1e-6) for _, _, target in rows]),
        angles=angles,
        names=tuple(f"{stop + 1}:{target.name}" for stop, _, target in rows),
    )


def _start(data: _Observations) -> tuple[Array, Array, Array]:
    """Direction, a point, and the targets at angle zero: linear in a circle's two arms.

    Each target moves on ``centre + a cos(angle) + b sin(angle)``; a × b is along the axis.
    """
    angle = data.angles[data.stop]
    design = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    centres, positions, normal = [], [], np.zeros(3)
    for number in range(int(data.target.max()) + 1):
        rows = data.target == number
        centre, a, b = np.linalg.lstsq(design[rows], data.points[rows], rcond=None)[0]
        # Summed, not averaged: a target farther from the axis knows its direction better.
        normal += np.cross(a, b)
        centres.append(centre)
        positions.append(centre + a)
    length = float(np.linalg.norm(normal))
    if length < 1e-6:
        raise AxisMotionInvalid("the targets do not move on circles")
    return normal / length, np.mean(centres, axis=0), np.stack(positions)


def _predict(data: _Observations, direction: Array, point: Array, positions: Array) -> Array:
    turns = Rotation.from_rotvec(np.outer(data.angles[data.stop], direction))
    return np.asarray(point + turns.apply(positions[data.target] - point))


def _whitening(
    data: _Observations, direction: Array, point: Array, noise: ArmNoise
) -> list[tuple[Indices, Array]]:
    """Per stop: its rows and the Cholesky factor of the covariance of their coordinates."""
    factors = []
    for stop in np.unique(data.stop):
        rows = np.flatnonzero(data.stop == stop)
        count = len(rows)
        # All targets of a stop share the displacement of the arm and the error of its angle.
        # Treated as independent, six targets would seem to average these away.
        tangent = np.cross(direction, data.points[rows] - point).ravel()
        covariance = np.diag(np.repeat(data.sigma[rows] ** 2, 3))
        covariance += np.kron(np.ones((count, count)), np.eye(3)) * noise.repeatability_m**2
        covariance += np.outer(tangent, tangent) * noise.angle_rad**2
        factors.append((rows, np.asarray(np.linalg.cholesky(covariance), dtype=float)))
    return factors


def perpendicular(direction: Array) -> Array:
    """Two unit vectors across ``direction``, shape (2, 3)."""
    least = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = skew(direction) @ least
    first = first / np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first)])
