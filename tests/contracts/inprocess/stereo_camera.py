"""A stereo head in memory."""

import numpy as np

from cellctl.clock import now_s
from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair
from tests.contracts.inprocess.exposure import InProcessExposure


class InProcessHead(InProcessExposure, StereoCamera):
    """Grey ramps that shift with each exposure."""

    async def grab(self) -> StereoPair:
        number = await self._expose()
        left = (np.add.outer(np.arange(4), np.arange(6)) + number).astype(np.uint8)
        return StereoPair(left, left + np.uint8(100), now_s(), number)
