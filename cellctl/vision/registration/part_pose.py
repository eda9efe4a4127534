"""Pose of a part in C1 from the holes that one or two heads measured."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import ResidualsTooLarge, TooFewHoles
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose, skew
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import Method, PairMeasurement
from cellctl.vision.registration.chi_square import ChiSquare, chi_square
from cellctl.vision.registration.paper_frame import paper_frame
from cellctl.vision.registration.rigid_fit import by_pose, on_a_line, register

RESIDUAL_LIMIT_M = 0.2e-3
"""Largest distance of a measured hole from its registered nominal position."""

_OUTLIER_SIGMAS = 5.0
_OUTLIER_MIN_HOLES = 5


@dataclass(frozen=True, slots=True, eq=False)
class PartPose:
    """A registered part."""

    pose: UncertainPose
    """``c1_T_part`` with everything that is known to be uncertain, the heads' transform too; wider
    where all that does not explain the residuals: a part off its drawing, a worn calibration."""
    own_covariance: Array
    """Shape (6, 6): from the hole measurements alone. The error of ``c1_T_c2`` is common to all
    parts that the same heads measure in the same place and cancels between them."""
    names: tuple[str, ...]
    residuals_m: Array
    """Measured minus registered, shape (n, 3), in C1, in the order of ``names``."""
    outliers: tuple[str, ...]
    """Holes that were left out of the registration."""
    misfit: ChiSquare
    """Consistency of the holes that were used."""


@dataclass(frozen=True, slots=True, eq=False)
class _Points:
    names: tuple[str, ...]
    nominal_m: Array
    measured_m: Array
    covariances_m2: Array
    """Covariances of the measured points in C1, shape (n, 3, 3)."""
    by_transfer: Array
    """Derivative of each point by the error of ``c1_T_c2``, shape (n, 3, 6)."""

    def joint_covariance(self, transfer_covariance: Array) -> Array:
        """Covariance of all coordinates with the errors shared by ``c1_T_c2``, (3n, 3n)."""
        shared = self.by_transfer.reshape(-1, 6)
        return np.asarray(
            block_diag(*self.covariances_m2) + shared @ transfer_covariance @ shared.T
        )

    def without(self, index: int) -> "_Points":
        keep = [i for i in range(len(self.names)) if i != index]
        return _Points(
            tuple(self.names[i] for i in keep),
            self.nominal_m[keep],
            self.measured_m[keep],
            self.covariances_m2[keep],
            self.by_transfer[keep],
        )


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
    ``holes``. Raises ``TooFewHoles`` or ``ResidualsTooLarge``.
    """
    transfer_covariance = np.zeros((6, 6)) if c1_T_c2 is None else c1_T_c2.covariance
    points = _points_in_c1(head_1, head_2, c1_T_c2, holes)
    if on_a_line(points.nominal_m):
        raise TooFewHoles(f"{len(points.names)} usable: {', '.join(points.names) or 'none'}")
    if method == "paper":
        return _by_paper(points, transfer_covariance)
    kept, outliers = _without_outliers(points, transfer_covariance, residual_limit_m)
    fit = register(kept.nominal_m, kept.measured_m, kept.covariances_m2)
    return _result(points, kept, transfer_covariance, fit.gain, pose=fit.pose, outliers=outliers)


def _points_in_c1(
    head_1: PairMeasurement,
    head_2: PairMeasurement | None,
    c1_T_c2: UncertainPose | None,
    holes: Sequence[Hole],
) -> _Points:
    """All measured points in C1, in the order of ``holes``."""
    rows: dict[str, tuple[Array, Array, Array]] = {
        hole.name: (hole.position_m, hole.covariance_m2, np.zeros((3, 6))) for hole in head_1.holes
    }
    if head_2 is not None:
        if c1_T_c2 is None:
            raise ValueError("points of a second head need c1_T_c2")
        rotation = c1_T_c2.pose.rotation.as_matrix()
        for hole in head_2.holes:
            turned = rotation @ hole.position_m
            rows[hole.name] = (
                turned + c1_T_c2.pose.translation,
                rotation @ hole.covariance_m2 @ rotation.T,
                np.hstack([np.eye(3), -skew(turned)]),
            )
    used = [hole for hole in holes if hole.name in rows]
    return _Points(
        tuple(hole.name for hole in used),
        np.array([hole.position_m for hole in used]).reshape(-1, 3),
        np.array([rows[hole.name][0] for hole in used]).reshape(-1, 3),
        np.array([rows[hole.name][1] for hole in used]).reshape(-1, 3, 3),
        np.array([rows[hole.name][2] for hole in used]).reshape(-1, 3, 6),
    )


def _without_outliers(
    points: _Points, transfer_covariance: Array, limit_m: float
) -> tuple[_Points, tuple[str, ...]]:
    """Leave out holes, one by one, that contradict all others; refuse what does not fit then."""
    kept = points
    outliers: list[str] = []
    while True:
        fit = register(kept.nominal_m, kept.measured_m, kept.covariances_m2)
        distances = np.linalg.norm(fit.residuals_m, axis=1)
        if distances.max() <= limit_m:
            return kept, tuple(outliers)
        # The hole with the largest residual need not be the wrong one, since a wrong hole drags the
        # pose towards itself. So each is left out in turn.
        worst = _contradicting(kept, transfer_covariance, limit_m)
        if worst is None:
            facts = ", ".join(
                f"{name} {distance / MM:.3f}"
                for name, distance in zip(kept.names, distances, strict=True)
            )
            raise ResidualsTooLarge(f"residuals in mm: {facts}; allowed {limit_m / MM:.3f}")
        outliers.append(kept.names[worst])
        kept = kept.without(worst)


def _contradicting(points: _Points, transfer_covariance: Array, limit_m: float) -> int | None:
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
        offset = points.measured_m[index] - fit.pose.apply(points.nominal_m[index])
        if np.linalg.norm(fit.residuals_m, axis=1).max() > limit_m:
            continue
        design = by_pose(fit.pose.rotation.apply(points.nominal_m[index])[None])[0]
        spread = (
            design @ _pose_covariance(fit.gain, rest, transfer_covariance) @ design.T
            + points.covariances_m2[index]
            + points.by_transfer[index] @ transfer_covariance @ points.by_transfer[index].T
        )
        sigmas = float(np.sqrt(offset @ np.linalg.solve(spread, offset)))
        if sigmas > _OUTLIER_SIGMAS:
            found.append((-sigmas, index))
    return min(found)[1] if found else None


def _pose_covariance(gain: Array, points: _Points, transfer_covariance: Array) -> Array:
    return np.asarray(gain @ points.joint_covariance(transfer_covariance) @ gain.T)


def _result(
    points: _Points,
    kept: _Points,
    transfer_covariance: Array,
    gain: Array,
    *,
    pose: RigidTransform,
    outliers: tuple[str, ...],
) -> PartPose:
    design = by_pose(pose.rotation.apply(kept.nominal_m)).reshape(-1, 6)
    joint = kept.joint_covariance(transfer_covariance)
    # The weights of the fit know only the measurement. The errors that points share by ``c1_T_c2``
    # enter here, where the gain carries them to the pose.
    unexplained = chi_square(_residuals_m(kept, pose), joint, design, gain)
    covariance = np.asarray(gain @ joint @ gain.T) * unexplained.growth
    return PartPose(
        UncertainPose(pose, covariance),
        _pose_covariance(gain, kept, np.zeros((6, 6))),
        points.names,
        _residuals_m(points, pose),
        outliers,
        unexplained,
    )


def _residuals_m(points: _Points, pose: RigidTransform) -> Array:
    return np.asarray(points.measured_m - pose.apply(points.nominal_m))


def _by_paper(points: _Points, transfer_covariance: Array) -> PartPose:
    """The paper's plane-and-line frame, carried to the drawing's frame by the nominal holes."""
    if len(points.names) != 6:
        raise TooFewHoles(f"the paper's frame needs six holes, got {len(points.names)}")
    pose = _paper_pose(points.nominal_m, points.measured_m)
    gain = _numeric_gain(points.nominal_m, points.measured_m, pose)
    return _result(points, points, transfer_covariance, gain, pose=pose, outliers=())


def _paper_pose(nominal_m: Array, measured_m: Array) -> RigidTransform:
    # The drawing's holes, seen from far above its face, give the same frame in part coordinates.
    above = np.array([0.0, 0.0, -1e3])
    seen = paper_frame(nominal_m + above)
    part_T_frame = RigidTransform.from_translation(-above) * seen
    return paper_frame(measured_m) * part_T_frame.inv()


def _numeric_gain(nominal_m: Array, measured_m: Array, pose: RigidTransform) -> Array:
    step_m = 1e-7
    gain = np.zeros((6, measured_m.size))
    for column in range(measured_m.size):
        moved = measured_m.copy()
        moved.flat[column] += step_m
        other = _paper_pose(nominal_m, moved)
        gain[:3, column] = (other.translation - pose.translation) / step_m
        gain[3:, column] = (other.rotation * pose.rotation.inv()).as_rotvec() / step_m
    return gain
