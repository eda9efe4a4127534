"""The way by which the tip came down, so that it can leave by the same one."""

import numpy as np

from cellctl.geometry.pose import Array

_STEP_M = 20e-6
"""A pose is kept when it is deeper than the last by this: less is the noise of the reports, and a
trail needs no finer points, since the way between them is straight."""


class Trail:
    """Poses of the tip, shape (6,), each deeper than the one before."""

    def __init__(self) -> None:
        self._poses: list[Array] = []

    def begin(self) -> None:
        """Forget the way so far: the tip came here sideways, so it can leave straight upwards."""
        self._poses.clear()

    def note(self, tip: Array) -> None:
        """The tip is here now; what was deeper is no longer on its way out."""
        while self._poses and self._poses[-1][2] >= tip[2] - _STEP_M:
            self._poses.pop()
        self._poses.append(tip)

    def out(self, tip: Array, height_m: float) -> Array:
        """Points (n, 6) from a pose to a height above the face, straight up from the face on."""
        below = [pose for pose in reversed(self._poses) if max(0.0, -height_m) < pose[2] < tip[2]]
        top = (below[-1] if below else tip).copy()
        top[2] = -height_m
        return np.stack([tip, *below, top])
