"""Places of the flange beside others, and by how much the moves of the process go there."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array

OVER_SOCKET_M = 20e-3
"""Height over the place at the socket at which the plug comes over it."""
AWAY_M = 5e-3
"""How far the arm goes away between two looks, so that it approaches its place anew."""
WAITING_M = 10e-3
"""Height of the tips over the socket's face while the arm waits for an operator who plugs."""
_LAST_JOINT = 5


def raised(base_T_flange: RigidTransform, height_m: float) -> RigidTransform:
    """The same flange, higher along z of the base."""
    return RigidTransform.from_translation([0.0, 0.0, height_m]) * base_T_flange


def shifted(base_T_flange: RigidTransform, x_m: float, y_m: float) -> RigidTransform:
    """The same flange, shifted along x and y of the base."""
    return RigidTransform.from_translation([x_m, y_m, 0.0]) * base_T_flange


def turned(joints_rad: Array, angle_rad: float) -> Array:
    """The same joints, shape (6,), with the last one turned by ``angle_rad`` to either side."""
    # Towards the middle of the joint's range: half a turn outwards may be beyond it.
    inwards = -1.0 if joints_rad[_LAST_JOINT] > 0 else 1.0
    found = np.array(joints_rad, float)
    found[_LAST_JOINT] += inwards * angle_rad
    return found
