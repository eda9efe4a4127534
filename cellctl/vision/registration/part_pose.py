"""Pose of a part in C1 from the holes that one or two heads measured."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import HeadsMoved, ResidualsTooLarge, TooFewHoles
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import Method, PairMeasurement
from cellctl.vision.registration.chi_square import ChiSquare, chi_square
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.paper_frame import paper_frame
from cellctl.vision.registration.rigid_fit import (
    Registration,
    by_pose,
    on_a_line,
    register,
)

RESIDUAL_LIMIT_M = 0.2e-3
"""Largest distance of a measured hole from its registered nominal position."""

_OUTLIER_SIGMAS = 5.0
"""A hole is left out only when it contradicts the others by this many standard deviations. Leaving
holes out until the rest fits would prove anything."""
_MOVEMENT_SIGMAS = 5.0
"""A movement of the heads beyond this is not believed; see ``_movement``."""
_OUTLIER_MIN_HOLES = 5
"""Least number of holes of which one may be left out."""
_ANY_MOVEMENT = 1e4
"""Factor on the variance of ``c1_T_c2`` with which a movement of any size is believed."""
_ONE_PIECE_M = 0.05e-3
"""What a movement of the heads may leave of the holes of a part that is right."""
_NO_TRANSFER = np.zeros((6, 6))


@dataclass(frozen=True, slots=True, eq=False)
class PartPose:
    """A registered part."""

    pose: UncertainPose
    """``c1_T_part`` with everything that is known to be uncertain, the heads' transform too; wider
    where all that does not explain the residuals: a part off its drawing, a worn calibration."""
    own_covariance: Array
    """Shape (6, 6): from the hole measurements alone, for two parts between which the error of
    ``c1_T_c2`` cancels (``relative_pose``)."""
    image_covariance: Array
    """Shape (6, 6): the share of ``own_covariance`` that the images make, which is what more images
    make smaller; what a part is off its drawing stays."""
    names: tuple[str, ...]
    residuals_m: Array
    """Measured minus registered, shape (n, 3), in C1, in the order of ``names``; without what the
    heads have most likely moved against each other, which is no fault of the part."""
    movement: Array
    """Most likely error of ``c1_T_c2``, shape (6,), in the order of ``UncertainPose``."""
    outliers: tuple[str, ...]
    """Holes that were left out of the registration."""
    misfit: ChiSquare
    """Consistency of the holes that were used."""
    points: MeasuredPoints
    """The holes that were used."""


def part_pose(
    head_1: PairMeasurement,
    head_2: PairMeasurement | None,
    c1_T_c2: UncertainPose | None,
    holes: Sequence[Hole],
    method: Method = "default",
    *,
    residual_limit_m: float = RESIDUAL_LIMIT_M,
) -> PartPose:
    """Register measured holes on the drawing.

    Default: weighted least squares on all holes, an outlier test from five holes on, full
    covariance. ``"paper"``: the frame of section 2.2.1 from exactly six holes P1…P6 in the order of
    ``holes``. Raises ``TooFewHoles``, ``HeadsMoved`` or ``ResidualsTooLarge``.
    """
    transfer_covariance = np.zeros((6, 6)) if c1_T_c2 is None else c1_T_c2.covariance
    points = MeasuredPoints.seen(head_1, head_2, c1_T_c2, holes)
    if on_a_line(points.nominal_m):
        raise TooFewHoles(f"{len(points.names)} usable: {', '.join(points.names) or 'none'}")
    if method == "paper":
        return _by_paper(points, transfer_covariance)
    seen, points = points, points.off_their_drawing(holes)
    kept, outliers = _without_outliers(points, transfer_covariance, residual_limit_m)
    fit = register(kept.nominal_m, kept.measured_m, kept.covariances_m2)
    images = _pose_covariance(fit.gain, kept.as_seen(seen), _NO_TRANSFER)
    return _result(points, kept, transfer_covariance, fit, images, outliers=outliers)


def _without_outliers(
    points: MeasuredPoints, transfer_covariance: Array, limit_m: float
) -> tuple[MeasuredPoints, tuple[str, ...]]:
    """Leave out holes, one by one, that contradict all others; refuse what does not fit then."""
    kept = points
    outliers: list[str] = []
    while True:
        fit = register(kept.nominal_m, kept.measured_m, kept.covariances_m2)
        movement = _movement(kept, fit, transfer_covariance)
        distances = np.linalg.norm(_own_residuals_m(kept, kept, fit, movement.error), axis=1)
        if distances.max() <= limit_m:
            return kept, tuple(outliers)
        # The hole with the largest residual need not be the wrong one, since a wrong hole drags the
        # pose towards itself. So each is left out in turn.
        worst = _contradicting(kept, transfer_covariance, limit_m)
        if worst is None:
            _refuse_moved_heads(kept, fit, transfer_covariance)
            facts = ", ".join(
                f"{name} {distance / MM:.3f}"
                for name, distance in zip(kept.names, distances, strict=True)
            )
            raise ResidualsTooLarge(f"residuals in mm: {facts}; allowed {limit_m / MM:.3f}")
        outliers.append(kept.names[worst])
        kept = kept.without(worst)


def _refuse_moved_heads(
    points: MeasuredPoints, fit: Registration, transfer_covariance: Array
) -> None:
    """Raise ``HeadsMoved`` when a movement of the heads, however large, explains all holes.

    Three holes before each head have six distances that no movement changes: a part that is wrong
    by its holes is not explained by one.
    """
    movement = _movement(points, fit, transfer_covariance * _ANY_MOVEMENT)
    left_m = np.linalg.norm(_own_residuals_m(points, points, fit, movement.error), axis=1).max()
    if not transfer_covariance.any() or left_m > _ONE_PIECE_M:
        return
    moved = ", ".join(f"{value:+.3f}" for value in in_mm_deg(movement.error))
    raise HeadsMoved(
        f"the holes before each head fit the drawing to {left_m / MM:.3f} mm, all of them only if "
        f"head II has moved by ({moved}) mm and degrees since both were calibrated"
    )


def _contradicting(
    points: MeasuredPoints, transfer_covariance: Array, limit_m: float
) -> int | None:
    """The one hole without which the others fit, if it is clearly off their registration."""
    if len(points.names) < _OUTLIER_MIN_HOLES:
        return None
    found: list[tuple[float, int]] = []
    for index in range(len(points.names)):
        rest = points.without(index)
        if on_a_line(rest.nominal_m):
            continue
        # The offset is judged against a pose in which this hole had no part; otherwise its own
        # error would be counted on both sides.
        fit = register(rest.nominal_m, rest.measured_m, rest.covariances_m2)
        movement = _movement(rest, fit, transfer_covariance)
        own_m = _own_residuals_m(rest, rest, fit, movement.error)
        if np.linalg.norm(own_m, axis=1).max() > limit_m:
            continue
        offset = _own_residuals_m(points, rest, fit, movement.error)[index]
        design = by_pose(fit.pose.rotation.apply(points.nominal_m[index])[None])[0]
        carried = _carried(points, rest, fit)[index]
        spread = (
            design @ _pose_covariance(fit.gain, rest, _NO_TRANSFER) @ design.T
            + points.covariances_m2[index]
            + carried @ movement.covariance @ carried.T
        )
        sigmas = float(np.sqrt(offset @ np.linalg.solve(spread, offset)))
        if sigmas > _OUTLIER_SIGMAS:
            found.append((-sigmas, index))
    return min(found)[1] if found else None


def _pose_covariance(gain: Array, points: MeasuredPoints, transfer_covariance: Array) -> Array:
    return np.asarray(gain @ points.joint_covariance(transfer_covariance) @ gain.T)


def _result(
    points: MeasuredPoints,
    kept: MeasuredPoints,
    transfer_covariance: Array,
    fit: Registration,
    image_covariance: Array,
    *,
    outliers: tuple[str, ...],
) -> PartPose:
    pose, gain = fit.pose, fit.gain
    design = by_pose(pose.rotation.apply(kept.nominal_m)).reshape(-1, 6)
    joint = kept.joint_covariance(transfer_covariance)
    # The weights of the fit know only the measurement. The errors that points share by ``c1_T_c2``
    # enter here, where the gain carries them to the pose.
    unexplained = chi_square(_residuals_m(kept, pose), joint, design, gain)
    movement = _movement(kept, fit, transfer_covariance)
    covariance = np.asarray(gain @ joint @ gain.T) * unexplained.growth
    return PartPose(
        UncertainPose(pose, covariance),
        _pose_covariance(gain, kept, _NO_TRANSFER),
        image_covariance,
        points.names,
        _own_residuals_m(points, kept, fit, movement.error),
        movement.error,
        outliers,
        unexplained,
        kept,
    )


def _residuals_m(points: MeasuredPoints, pose: RigidTransform) -> Array:
    return np.asarray(points.measured_m - pose.apply(points.nominal_m))


@dataclass(frozen=True, slots=True, eq=False)
class _Movement:
    """Most likely error of ``c1_T_c2``, (6,), and what stays unknown of it, (6, 6)."""

    error: Array
    covariance: Array


def _movement(points: MeasuredPoints, fit: Registration, transfer_covariance: Array) -> _Movement:
    """The most likely error of ``c1_T_c2``, from the residuals of the registration.

    A Kalman update from zero: ``transfer_covariance`` is what is known of the error before, the
    holes of head II are what tells of it.
    """
    shared = _carried(points, points, fit).reshape(-1, 6)
    spread = shared @ transfer_covariance @ shared.T + block_diag(*points.covariances_m2)
    gain = np.linalg.solve(spread, shared @ transfer_covariance).T
    error = gain @ _residuals_m(points, fit.pose).ravel()
    # A movement that nobody expects of the heads is none: something else is wrong with the points.
    if error @ np.linalg.pinv(transfer_covariance) @ error > _MOVEMENT_SIGMAS**2:
        error = np.zeros(6)
    return _Movement(error, transfer_covariance - gain @ shared @ transfer_covariance)


def _own_residuals_m(
    points: MeasuredPoints, kept: MeasuredPoints, fit: Registration, movement: Array
) -> Array:
    """Residuals of points, (n, 3), without what the movement of the heads does to them."""
    return _residuals_m(points, fit.pose) - _carried(points, kept, fit) @ movement


def _carried(points: MeasuredPoints, kept: MeasuredPoints, fit: Registration) -> Array:
    """Derivative of the residuals of points by the error of ``c1_T_c2``, (n, 3, 6).

    The pose, which follows from the points that were kept, absorbs a part of it.
    """
    absorbed = fit.gain @ kept.by_transfer.reshape(-1, 6)
    design = by_pose(fit.pose.rotation.apply(points.nominal_m))
    return np.asarray(points.by_transfer - design @ absorbed)


def _by_paper(points: MeasuredPoints, transfer_covariance: Array) -> PartPose:
    """The paper's plane-and-line frame, carried to the drawing's frame by the nominal holes."""
    if len(points.names) != 6:
        raise TooFewHoles(f"the paper's frame needs six holes, got {len(points.names)}")
    pose = _paper_pose(points.nominal_m, points.measured_m)
    gain = _numeric_gain(points.nominal_m, points.measured_m, pose)
    fit = Registration(pose, _residuals_m(points, pose), gain)
    # Its frame knows nothing of how far the holes may be off their drawing.
    images = _pose_covariance(fit.gain, points, _NO_TRANSFER)
    return _result(points, points, transfer_covariance, fit, images, outliers=())


def _paper_pose(nominal_m: Array, measured_m: Array) -> RigidTransform:
    # The drawing's holes, seen from far above its face, give the same frame in part coordinates.
    above = np.array([0.0, 0.0, -1e3])
    seen = paper_frame(nominal_m + above)
    part_T_frame = RigidTransform.from_translation(-above) * seen
    return paper_frame(measured_m) * part_T_frame.inv()


def _numeric_gain(nominal_m: Array, measured_m: Array, pose: RigidTransform) -> Array:
    # The paper's frame is a construction, not a least-squares fit: it has no gain in closed form.
    step_m = 1e-7
    gain = np.zeros((6, measured_m.size))
    for column in range(measured_m.size):
        moved = measured_m.copy()
        moved.flat[column] += step_m
        other = _paper_pose(nominal_m, moved)
        gain[:3, column] = (other.translation - pose.translation) / step_m
        gain[3:, column] = (other.rotation * pose.rotation.inv()).as_rotvec() / step_m
    return gain
