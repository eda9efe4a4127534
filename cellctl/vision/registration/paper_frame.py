"""The part frame of the paper (section 2.2.1), for its baseline."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array


def paper_frame(points_m: Array) -> RigidTransform:
    """Frame on six holes (section 2.2.1), shape (6, 3) in the order P1…P6, in one camera's frame.

    Plane through all points by least squares, points projected on it, origin at P1'', x along
    P1''→P5'', z the plane's normal towards the camera, y right-handed.
    """
    middle = points_m.mean(axis=0)
    normal = np.linalg.svd(points_m - middle)[2][2]
    normal = normal if normal @ middle < 0 else -normal
    flat = points_m - np.outer((points_m - middle) @ normal, normal)
    along = flat[4] - flat[0]
    along /= np.linalg.norm(along)
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([along, np.cross(normal, along), normal])
    matrix[:3, 3] = flat[0]
    return RigidTransform.from_matrix(matrix)
