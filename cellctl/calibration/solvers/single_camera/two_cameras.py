"""Whether the views that are to calibrate one camera were taken by the two of one head.

Two cameras that are nearly alike make one that fits both, with small residuals. What tells is that
each pose of the board was then seen twice: from one view of a pair to the other the board seems to
have gone by the pose of the head, the same in all pairs.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cellctl.geometry.pose import Array

_SAME_RAD, _SAME_OF_DISTANCE = 0.02, 0.02
"""Two such changes of pose are one within this, lenses being hardly known; of boards that a person
moved, not one in ten million is."""
_LEAST_TURN_RAD = float(np.radians(3.0))
"""Cameras of a head look at one place. Of boards that were moved in steps without a turn, many
changes of pose are the same as well."""
MOST_PAIRED = 0.5
"""Where files of a second camera came among the others, nearly all views are paired off."""
_FIRST = 8
"""If the cameras are two, at least some of so many views have their counterpart."""


def share_of_pairs(camera_T_board: Array) -> float:
    """Share of the views, ``camera_T_board`` of shape (n, 4, 4), that one change of pose pairs off.

    1 when they are those of two cameras, and next to 0 for views of one.
    """
    count = len(camera_T_board)
    changes = camera_T_board[None] @ np.linalg.inv(camera_T_board)[:, None]
    turns = Rotation.from_matrix(changes[:, :, :3, :3].reshape(-1, 3, 3))
    shifts_m = changes[:, :, :3, 3].reshape(-1, 3)
    near_m = _SAME_OF_DISTANCE * float(np.median(camera_T_board[:, 2, 3]))

    def alike(index: int) -> NDArray[np.bool_]:
        found: NDArray[np.bool_] = np.linalg.norm(shifts_m - shifts_m[index], axis=1) < near_m
        found[found] = (turns[np.flatnonzero(found)] * turns[index].inv()).magnitude() < _SAME_RAD
        return found

    turned = np.flatnonzero(turns[: min(_FIRST, count) * count].magnitude() >= _LEAST_TURN_RAD)
    same = {int(index): alike(int(index)) for index in turned}
    if not same:
        return 0.0
    best = max(same, key=lambda index: int(same[index].sum()))
    # There and back again, from the one camera to the other: that is all of a head. A turntable
    # and a grid of places repeat other changes as well.
    of_head = same[best] | same[best].reshape(count, count).T.ravel()
    others = [int(found.sum()) for index, found in same.items() if not of_head[index]]
    if max(others, default=0) > same[best].sum() / 2:
        return 0.0
    pairs = of_head.reshape(count, count)
    return float(pairs.any(axis=1).mean())
