"""Holes that are all measured as wider or narrower than their drawing has them.

A rim is measured up to 7 % off its nominal size (``rim.roi``). So a drawing of another part, or a
head with a wrong scale, need not fail there, and is told here.
"""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.pose import MM
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import PairMeasurement

_OFF = 0.03
"""Relative difference from the drawing that is told. Chamfers, light and blur move a rim by less on
a hole of 5 mm."""
_ALIKE = 0.01
"""Largest difference between the ratios of the holes: the mistake is the same for all of them."""


def other_diameters(result: PairMeasurement, holes: Sequence[Hole]) -> str:
    """Words for a drawing, or for a scale of the head, that is another one; empty where holes fit.

    All holes have to be off by the same share: one alone may have a burr.
    """
    stated_m = {hole.name: hole.diameter_m for hole in holes}
    ratios = np.array([hole.diameter_m / stated_m[hole.name] for hole in result.holes])
    if len(ratios) == 0 or np.ptp(ratios) > _ALIKE or abs(np.median(ratios) - 1.0) < _OFF:
        return ""
    hole = result.holes[0]
    return (
        f"all holes are {np.median(ratios):.3f} times as wide as here, such as {hole.name}: "
        f"{hole.diameter_m / MM:.2f} mm, diameter_mm = {stated_m[hole.name] / MM:g}. Another part, "
        "a radius, or a stereo calibration with a wrong square_mm or baseline"
    )
