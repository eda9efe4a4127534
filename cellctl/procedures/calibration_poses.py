"""The views from which a head looks at the board while its cameras are calibrated."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

TILTS_DEG = (-22.0, -11.0, 0.0, 11.0, 22.0)
DISTANCE_CHANGES_M = (0.0, -0.06, 0.03)
"""Along the line of sight: back and forth."""
UPRIGHT_SHIFTS_M = ((0.0, 0.0), (0.03, 0.03), (-0.03, 0.03), (-0.03, -0.03), (0.03, -0.03))
TURNED_SHIFTS_M = ((0.0, 0.0), (0.05, 0.0), (-0.05, 0.0))
"""Shifts of the board in the image plane; a turned board nearly fills the height of the field."""


def stereo_views(count: int, pivot_m: np.ndarray) -> list[RigidTransform]:
    """``head_T_view``: poses of the head relative to its present one, all looking at the board.

    The head swings about ``pivot_m`` (shape (3,), the board's middle in the present head frame):
    tilted about both image axes, turned about the line of sight by a quarter so that lens
    and board errors separate, nearer and farther, and shifted so that corners of the field are
    covered. The first view is the present pose itself.
    """
    views = [RigidTransform.identity()]
    rng = np.random.default_rng(0)  # a fixed, well-spread plan: the same at every calibration
    for index in range(1, count):
        tilt_x, tilt_y = rng.permutation(TILTS_DEG)[:2]
        turned = index % 2 == 1
        rotation = Rotation.from_euler("ZYX", [90.0 * turned, tilt_y, tilt_x], degrees=True)
        shifts = TURNED_SHIFTS_M if turned else UPRIGHT_SHIFTS_M
        shift = (*shifts[index // 2 % len(shifts)], DISTANCE_CHANGES_M[index % 3])
        # Turned about the board, not about the head: the board then stays in the middle of the
        # field, however far the head tilts.
        swing = (
            RigidTransform.from_translation(pivot_m)
            * RigidTransform.from_rotation(rotation)
            * RigidTransform.from_translation(-pivot_m)
        )
        views.append(swing * RigidTransform.from_translation(shift))
    return views
