"""Which flat bodies can be in the image of a camera at all."""

import numpy as np
from scipy.spatial.transform import RigidTransform

_FACING_MIN = 0.6
"""Cosine of the greatest angle between a face's normal and the line of sight, 53 degrees."""
_NEAREST_M = 0.15
_SLOPE_MAX = 0.5
"""Half the field of view of a stereo head is about 0.34 times the distance."""


def in_view(
    camera_T_plate: RigidTransform, size_m: tuple[float, float], slope_max: float = _SLOPE_MAX
) -> bool:
    """True when part of a plate's face can be in an image; generous at the edges.

    ``slope_max``: tangent of the angle beside the line of sight up to which a camera sees.
    The world has arms elsewhere: a deck behind the camera, edge-on or far aside is not seen.
    """
    facing = float(camera_T_plate.rotation.as_matrix()[2, 2]) < -_FACING_MIN
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 17), np.linspace(-0.5, 0.5, 9))
    face = np.column_stack([x.ravel() * size_m[0], y.ravel() * size_m[1], np.zeros(x.size)])
    points = camera_T_plate.apply(face)
    ahead = points[points[:, 2] > _NEAREST_M]
    slopes = np.abs(ahead[:, :2] / ahead[:, 2:])
    return facing and bool((slopes < slope_max).all(axis=1).any())
