"""Poses as records hold them: mm, and degrees in the order that the controller's hello names."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.euler import angles_of, rotation_of
from cellctl.geometry.euler_order import EulerOrder
from cellctl.geometry.pose import MM


def read_pose(xyzabc: Sequence[float], order: EulerOrder) -> RigidTransform:
    """A pose of six finite numbers."""
    places = np.array(xyzabc, dtype=float)
    # A record has its angles about z, y and x, the rotation takes them about x, y and z.
    rotation = rotation_of(order, np.radians(places[:2:-1]))
    return RigidTransform.from_components(places[:3] * MM, rotation)


def write_pose(pose: RigidTransform, order: EulerOrder) -> list[float]:
    """The six numbers of a finite pose; the inverse of ``read_pose``."""
    c_b_a = np.degrees(angles_of(order, pose.rotation))
    return [*(pose.translation / MM).tolist(), *c_b_a[::-1].tolist()]
