"""Where a head looks from while its cameras are calibrated."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

TILTS_DEG = (-22.0, -11.0, 0.0, 11.0, 22.0)
DISTANCE_CHANGES_M = (0.0, -0.04, 0.05)
SHIFTS_M = ((0.0, 0.0), (0.045, 0.03), (-0.045, 0.03), (-0.045, -0.03), (0.045, -0.03))


def stereo_views(count: int, pivot_m: np.ndarray) -> list[RigidTransform]:
    """``head_T_view``: poses of the head relative to its present one, all looking at the board.

    The head swings about ``pivot_m`` (shape (3,), the board's middle in the present head frame):
    tilted about both image axes, turned about the line of sight by quarter turns so that lens
    and board errors separate, nearer and farther, and shifted so that corners of the field are
    covered. The first view is the present pose itself.
    """
    views = [RigidTransform.identity()]
    rng = np.random.default_rng(0)  # a fixed, well-spread plan: the same at every calibration
    for index in range(1, count):
        tilt_x, tilt_y = rng.permutation(TILTS_DEG)[:2]
        turn = 90.0 * (index % 2)  # more quarter turns would wind up the wrist
        rotation = Rotation.from_euler("ZYX", [turn, tilt_y, tilt_x], degrees=True)
        shift = (*SHIFTS_M[index % len(SHIFTS_M)], DISTANCE_CHANGES_M[index % 3])
        swing = (
            RigidTransform.from_translation(pivot_m)
            * RigidTransform.from_rotation(rotation)
            * RigidTransform.from_translation(-pivot_m)
        )
        views.append(swing * RigidTransform.from_translation(shift))
    return views
