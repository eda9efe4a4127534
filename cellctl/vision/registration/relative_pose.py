"""Pose of one part in another, both measured by the same two heads at the same poses.

Each part alone leans on ``c1_T_c2``. Where heads have moved against each other since that was
calibrated, the holes of a part no longer fit together, and how the misfit is shared out depends on
the weights of its holes. Two parts with differently certain holes share it out differently, so that
subtracting their poses leaves an error of the size of the movement. Here both parts and the
movement are estimated together: what is near each other in the view of one head is compared there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose, perturbed, skew
from cellctl.vision.registration.chi_square import ChiSquare
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.rigid_fit import by_pose

_PART_1, _PART_2, _HEADS = slice(0, 6), slice(6, 12), slice(12, 18)


@dataclass(frozen=True, slots=True, eq=False)
class RelativePose:
    """The pose of one part in the other."""

    part_1_T_part_2: UncertainPose
    """Its covariance follows from the uncertainties that are stated, of the holes and of the heads'
    movement."""
    movement: Array
    """Estimated error of ``c1_T_c2``, shape (6,), in the order of ``UncertainPose``."""
    misfit: ChiSquare
    """Whether holes and movement are explained by what is known of them."""

    @property
    def cautious(self) -> UncertainPose:
        """The pose with a covariance that has grown where what is stated does not explain the
        holes."""
        plain = self.part_1_T_part_2
        return UncertainPose(plain.pose, plain.covariance * self.misfit.growth)


def relative_pose(
    part_1: MeasuredPoints,
    part_2: MeasuredPoints,
    c1_T_part_1: RigidTransform,
    c1_T_part_2: RigidTransform,
    transfer_covariance: Array,
    *,
    sway_m: float = 0.0,
) -> RelativePose:
    """Least squares over the holes of both parts and the error of ``c1_T_c2`` that they share.

    The poses are those of each part alone, to start from. ``transfer_covariance`` (6, 6) says what
    is known of ``c1_T_c2``: its calibration, and how far the heads may have moved since. It must
    have full rank. ``sway_m`` is how far the arms of the heads sway in one picture, standard
    deviation along x and y of C1: it shifts all holes of one head alike and leaves no misfit.
    """
    poses = [c1_T_part_1, c1_T_part_2]
    movement: Array = np.zeros(6)
    prior = np.asarray(np.linalg.inv(transfer_covariance), dtype=np.float64)
    # The starting poses are within tenths of a millimetre; the third step changes nothing any more.
    for _ in range(3):
        normal, gradient, _ = _equations((part_1, part_2), poses, movement, prior)
        step = np.asarray(np.linalg.solve(normal, gradient), dtype=np.float64)
        poses = [perturbed(poses[0], step[_PART_1]), perturbed(poses[1], step[_PART_2])]
        movement = movement + step[_HEADS]
    normal, _, chi2 = _equations((part_1, part_2), poses, movement, prior)
    # Two poses are six unknowns each. The six of the movement come with six observations of their
    # own, what is known of it beforehand, and cancel.
    freedom = 3 * (len(part_1.names) + len(part_2.names)) - 12
    misfit = ChiSquare(chi2, freedom)
    covariance = _covariance((part_1, part_2), poses, normal, sway_m)
    return RelativePose(UncertainPose(poses[0].inv() * poses[1], covariance), movement, misfit)


def relative_covariance(
    part_1: MeasuredPoints,
    part_2: MeasuredPoints,
    c1_T_part_1: RigidTransform,
    c1_T_part_2: RigidTransform,
    transfer_covariance: Array,
    *,
    sway_m: float = 0.0,
) -> Array:
    """That of ``relative_pose`` alone, (6, 6), for poses that already fit: nothing is estimated."""
    parts, poses = (part_1, part_2), (c1_T_part_1, c1_T_part_2)
    prior = np.asarray(np.linalg.inv(transfer_covariance), dtype=np.float64)
    normal, _, _ = _equations(parts, poses, np.zeros(6), prior)
    return _covariance(parts, poses, normal, sway_m)


def _covariance(
    parts: tuple[MeasuredPoints, MeasuredPoints],
    poses: Sequence[RigidTransform],
    normal: Array,
    sway_m: float,
) -> Array:
    """Of the second part in the first one, shape (6, 6)."""
    jacobian = _by_poses(*poses)
    known = np.asarray(np.linalg.inv(normal), dtype=np.float64)
    of_poses = known[:12, :12] + _by_sway(parts, poses, known, sway_m)[:12, :12]
    return np.asarray(jacobian @ of_poses @ jacobian.T)


def _equations(
    parts: tuple[MeasuredPoints, MeasuredPoints],
    poses: Sequence[RigidTransform],
    movement: Array,
    prior: Array,
) -> tuple[Array, Array, float]:
    """Normal matrix (18, 18), gradient (18,) and weighted sum of squares."""
    normal, gradient = np.zeros((18, 18)), np.zeros(18)
    normal[_HEADS, _HEADS] = prior
    gradient[_HEADS] = -prior @ movement
    chi2 = float(movement @ prior @ movement)
    for points, pose, place in zip(parts, poses, (_PART_1, _PART_2), strict=True):
        turned_m = pose.rotation.apply(points.nominal_m)
        design = np.zeros((len(points.names), 3, 18))
        design[:, :, place] = by_pose(turned_m)
        design[:, :, _HEADS] = points.by_transfer
        residuals_m = (
            points.measured_m - turned_m - pose.translation - points.by_transfer @ movement
        )
        weights = np.linalg.inv(points.covariances_m2)
        normal += np.einsum("nij,nik,nkl->jl", design, weights, design)
        gradient += np.einsum("nij,nik,nk->j", design, weights, residuals_m)
        chi2 += float(np.einsum("ni,nij,nj->", residuals_m, weights, residuals_m))
    return normal, gradient, chi2


def _by_sway(
    parts: tuple[MeasuredPoints, MeasuredPoints],
    poses: Sequence[RigidTransform],
    known: Array,
    sway_m: float,
) -> Array:
    """What the sway of both heads adds to the covariance ``known``, shape (18, 18)."""
    added = np.zeros((18, 18))
    for points, pose, place in zip(parts, poses, (_PART_1, _PART_2), strict=True):
        design = np.zeros((len(points.names), 3, 18))
        design[:, :, place] = by_pose(pose.rotation.apply(points.nominal_m))
        design[:, :, _HEADS] = points.by_transfer
        weighted = np.linalg.inv(points.covariances_m2) @ design
        # Only points that head II saw depend on c1_T_c2. Each head sways by itself, so what both
        # do adds in squares; in the average over several pictures it shrinks like any noise.
        of_head_2 = points.by_transfer.any(axis=(1, 2))
        for of_head in (of_head_2, ~of_head_2):
            gain = known @ weighted[of_head].sum(axis=0)[:2].T
            added += gain @ gain.T * sway_m**2 / points.frames
    return added


def _by_poses(c1_T_part_1: RigidTransform, c1_T_part_2: RigidTransform) -> Array:
    """Derivative of ``part_1_T_part_2`` by both poses in c1, shape (6, 12)."""
    # With R1, t1 and R2, t2 the place of part 2 in part 1 is R1ᵀ (t2 - t1): moving both parts
    # alike changes nothing, and a turn of part 1 swings the lever between them.
    into_1 = c1_T_part_1.rotation.inv().as_matrix()
    between = c1_T_part_2.translation - c1_T_part_1.translation
    jacobian = np.zeros((6, 12))
    jacobian[:, _PART_2] = np.kron(np.eye(2), into_1)
    jacobian[:, _PART_1] = -jacobian[:, _PART_2]
    jacobian[:3, 3:6] = into_1 @ skew(between)
    return jacobian
