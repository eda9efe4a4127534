"""Rigid registration of measured points on their nominal positions, weighted by covariance."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import perturbed, skews


@dataclass(frozen=True, slots=True, eq=False)
class Registration:
    """``camera_T_part`` that carries nominal points onto measured ones."""

    pose: RigidTransform
    residuals_m: Array
    """Measured minus fitted, shape (n, 3), camera frame."""
    gain: Array
    """Derivative of the pose (order of ``UncertainPose``) by the measured points, (6, 3n)."""


def kabsch(nominal_m: Array, measured_m: Array) -> tuple[Array, Array]:
    """Unweighted least-squares rotation (3, 3) and translation (3,) that carry nominal points onto
    measured ones; at least three that are not on a line."""
    nominal_mean, measured_mean = nominal_m.mean(axis=0), measured_m.mean(axis=0)
    u, _, vt = np.linalg.svd((measured_m - measured_mean).T @ (nominal_m - nominal_mean))
    # Noise on points that lie in a plane can make a reflection the best orthogonal matrix.
    u[:, 2] *= np.sign(np.linalg.det(u @ vt))
    rotation = u @ vt
    return rotation, measured_mean - rotation @ nominal_mean


def misfits_m(nominal_m: Array, measured_m: Array) -> Array:
    """Distances (n,) that the unweighted least-squares pose leaves."""
    rotation, translation_m = kabsch(nominal_m, measured_m)
    rest_m = measured_m - nominal_m @ rotation.T - translation_m
    return np.asarray(np.linalg.norm(rest_m, axis=1))


def register(nominal_m: Array, measured_m: Array, covariances_m2: Array) -> Registration:
    """Generalised least squares; ``covariances_m2`` has shape (n, 3, 3)."""
    rotation, translation_m = kabsch(nominal_m, measured_m)
    pose = RigidTransform.from_components(translation_m, Rotation.from_matrix(rotation))
    weights = np.linalg.inv(covariances_m2)
    gain = np.zeros((6, 3 * len(nominal_m)))
    # The unweighted start is within the noise of the answer: four Gauss-Newton steps reach
    # rounding.
    for _ in range(4):
        turned = pose.rotation.apply(nominal_m)
        residuals = measured_m - turned - pose.translation
        design = by_pose(turned)
        weighted = np.einsum("nij,njk->nik", weights, design)
        normal = np.einsum("nij,nik->jk", design, weighted)
        gain = np.linalg.solve(normal, np.concatenate(list(weighted)).T)
        step = gain @ residuals.ravel()
        pose = perturbed(pose, step)
    residuals = measured_m - pose.apply(nominal_m)
    return Registration(pose, residuals, gain)


def by_pose(turned_m: Array) -> Array:
    """Derivative of points by the pose (order of ``UncertainPose``), shape (n, 3, 6).

    ``turned_m`` (n, 3) are the nominal points in the axes of the camera.
    """
    eye = np.broadcast_to(np.eye(3), (len(turned_m), 3, 3))
    return np.concatenate([eye, -skews(turned_m)], axis=2)


def on_a_line(points_m: Array, ratio: float = 0.01) -> bool:
    """Whether points, shape (n, 3), fail to span a plane: their spread across is less than
    ``ratio`` of that along."""
    if len(points_m) < 3:
        return True
    spread = np.linalg.svd(points_m - points_m.mean(axis=0), compute_uv=False)
    # A deck of 5 m that is seen at two corners has 0.03: the turn about the line between them is
    # known worst, and its covariance says so. Below 0.01 it would be known a hundred times worse
    # than that across the line, and a hole that is off its drawing would decide it.
    return bool(spread[1] < ratio * spread[0])
