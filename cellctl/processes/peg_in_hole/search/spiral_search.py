"""An upright peg slides along an expanding spiral until the face carries it no more."""

from typing import ClassVar

import numpy as np

from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.search.probe import UPRIGHT, TouchProbe
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy

_PASSES = 4
"""Spirals over the same place (section 3.6 of the study of insertion by touch)."""


class SpiralSearch(SearchStrategy):
    """Search for holes with chamfers: simple, and fast where the catch radius is wide."""

    name: ClassVar[SearchName] = SearchName.SPIRAL

    async def find(self, probe: TouchProbe) -> bool:
        """Spiral up to four times, since the errors of the path differ from pass to pass."""
        centre_m = np.zeros(2)
        for _ in range(_PASSES):
            await probe.touch_down(centre_m, UPRIGHT)
            if await probe.enters() or await probe.spiral(centre_m, probe.task.search_radius_m):
                return True
        return False
