"""Conversion from SI to the units in which people read poses."""

import numpy as np

from cellctl.geometry.pose import MM, Array


def in_mm_deg(components: Array) -> Array:
    """x, y, z, rx, ry, rz from m and rad to mm and degrees, shape (6,)."""
    return np.concatenate([components[:3] / MM, np.degrees(components[3:])])
