"""Holes that are all measured as wider or narrower than their drawing has them."""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.pose import MM
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import PairMeasurement

_OFF = 0.03
"""Of the diameter: chamfers, light and blur move a rim by less on a hole of 5 mm."""
_ALIKE = 0.01


def other_diameters(result: PairMeasurement, holes: Sequence[Hole]) -> str:
    """That the drawing, or the scale of the head, is another one; empty where holes fit.

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
