"""Whether a sensor reads a weight with the sign that contacts are judged by.

In contact the deck is pushed away from its seat, against the weight. A sensor that reads it the
other way round takes a contact for a pull: it is found too late, by the limit alone. No residual
shows that, because the compensation subtracts a weight of either sign.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.force.gravity.acceptance import PayloadCheck
from cellctl.force.gravity.payload import Rigid12

_AXES = "xyz"
_EXPLAINED = 0.85
"""Of an offset by another sign: above it the offset is twice the weight within 15 %."""
_MOST_UPWARDS = 0.5
"""Share of the weight; a base that leans so far no arm has."""


def reversed_axis_check(rigid: Rigid12, base_R_sensor: Rotation) -> PayloadCheck:
    """One axis alone with the other sign.

    Near one attitude its offset takes that up: it is then twice the weight, while that of a sensor
    in order is a small share of it. ``base_R_sensor`` holds the poses of the fit.
    """
    weight_n = base_R_sensor.inv().apply(rigid.weight_n).mean(axis=0)
    axis = int(np.argmax(np.abs(weight_n)))
    ratio = -float(rigid.force_offset_n[axis] / weight_n[axis]) / 2.0
    explained = max(0.0, 1.0 - abs(ratio - 1.0))
    name = f"share of the offset that f{_AXES[axis]} with the other sign explains"
    return PayloadCheck(name, explained, _EXPLAINED, "")


def reaction_check(rigid: Rigid12) -> PayloadCheck:
    """All axes with the other sign: the sensor states what it does to its load."""
    upwards = max(0.0, float(rigid.weight_n[2] / np.linalg.norm(rigid.weight_n)))
    name = "share of the weight that reads upwards (then set 'inverted' of the sensor otherwise)"
    return PayloadCheck(name, upwards, _MOST_UPWARDS, "")
