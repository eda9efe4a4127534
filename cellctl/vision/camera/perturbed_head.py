"""Heads that are as likely as the calibrated one, by the covariance of the calibration.

With them anything that is computed from a head gets its share of the calibration's uncertainty: it
is computed once for each of them, without any derivative of it having to be known.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead

_NOTHING = 1e-12
"""Directions whose variance is below this share of the greatest one are rounding."""


def perturbed_heads(head: StereoHead) -> Iterator[StereoHead]:
    """The head moved by one standard deviation along each direction of its covariance.

    Sums over the squares of what each of them changes give the variance of anything that is
    computed from the head, to first order. None for a head whose covariance is not known.
    """
    if head.covariance is None:
        return
    # Pixels, plain numbers and radians are of very different size: directions are those of the
    # correlation, or small numbers would drown in the rounding of large ones.
    sigma = np.sqrt(np.diag(head.covariance))
    safe = np.where(sigma > 0.0, sigma, 1.0)
    values, vectors = np.linalg.eigh(head.covariance / np.outer(safe, safe))
    for value, vector in zip(values, vectors.T, strict=True):
        if value > _NOTHING * values[-1]:
            yield moved_head(head, np.sqrt(value) * vector * sigma)


def moved_head(head: StereoHead, delta: Array) -> StereoHead:
    """The head with a small change of its numbers, in the order of ``parameter_order``."""
    count = 4 + len(head.left.distortion)
    return replace(
        head,
        left=_moved_camera(head.left, delta[:count]),
        right=_moved_camera(head.right, delta[count : 2 * count]),
        rotation=Rotation.from_rotvec(delta[-6:-3]).as_matrix() @ head.rotation,
        translation_m=head.translation_m + delta[-3:],
    )


def _moved_camera(camera: CameraModel, delta: Array) -> CameraModel:
    fx, fy, cx, cy = delta[:4]
    moved = camera.camera_matrix + np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 0.0]])
    return CameraModel(moved, camera.distortion + delta[4:])
