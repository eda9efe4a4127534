"""The weighted mean of several determinations of one pose."""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.pose import pose_error
from cellctl.geometry.uncertain import UncertainPose, perturbed


def average(poses: Sequence[UncertainPose]) -> tuple[UncertainPose, float]:
    """Mean and reduced chi square (1 when the poses agree within their covariances; 0 for one).

    The covariance grows with the chi square where that is above 1.
    """
    # The mean is found around a reference that moves: rotations have no mean of their own.
    mean = poses[0].pose
    if len(poses) == 1:
        return poses[0], 0.0
    # Weighted with the full covariances: a pose that is sure of its height and unsure of its tilt
    # counts for the one and not for the other.
    weights = [np.linalg.inv(pose.covariance) for pose in poses]
    covariance = np.linalg.inv(np.sum(weights, axis=0))
    for _ in range(5):
        deltas = [np.concatenate(pose_error(mean, pose.pose)) for pose in poses]
        pulls = np.sum([w @ d for w, d in zip(weights, deltas, strict=True)], axis=0)
        mean = perturbed(mean, covariance @ pulls)
    deltas = [np.concatenate(pose_error(mean, pose.pose)) for pose in poses]
    squares = sum(float(d @ w @ d) for w, d in zip(weights, deltas, strict=True))
    # Six unknowns are spent on the mean.
    chi2_ratio = squares / (6 * (len(poses) - 1))
    return UncertainPose(mean, covariance * max(1.0, chi2_ratio)), chi2_ratio
