"""Whether a sensor reads a weight with the sign that contacts are judged by.

In contact the deck is pushed away from its seat, against the weight. A sensor that reads it the
other way round takes a contact for a pull: it is found too late, by the limit alone. No residual
shows that, because the compensation subtracts a weight of either sign. Nor does any show torques of
the other sign, where the centre of mass lies on the other side of the sensor, or of axes that were
exchanged.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.force.gravity.acceptance import PayloadCheck
from cellctl.force.gravity.payload import Rigid12
from cellctl.geometry.pose import MM, Array

_AXES = "xyz"
_EXPLAINED = 0.85
"""Of an offset by another sign: above it the offset is twice the weight within 15 %."""
_MOST_UNEXPLAINED = 0.25
"""Half of what the mildest exchange of two axes leaves (0.51 of the sample), and far more than a
sensor with 1 % cross-talk does (0.005)."""
_LEAST_CHANGE_N_M = 0.2
"""Torques that change by less are noise and cables: nothing is said of their axes."""
_MOST_UPWARDS = 0.5
"""Share of the weight; a base that leans so far no arm has."""
_MOST_AWAY = 0.5
"""Share of the lever. Within 30° of the horizontal nothing is said: whether a load that sticks out
sideways is above or below its sensor is a matter of its shape."""


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


def torque_axes_check(rigid: Rigid12, wrenches: Array) -> PayloadCheck:
    """Torques of two axes exchanged, or one alone with the other sign.

    The compensation takes up any linear relation between the axes, so its residuals stay small. A
    rigid load allows one alone, c × f. ``wrenches`` are those of the fit, shape (n, 6).
    """
    change_n_m = np.ptp(wrenches[:, 3:], axis=0).max()
    spread = wrenches[:, 3:] - wrenches[:, 3:].mean(axis=0)
    left, whole = (float(np.sqrt(np.mean(of**2))) for of in (rigid.residual[:, 3:], spread))
    share = left / whole if change_n_m > _LEAST_CHANGE_N_M else 0.0
    name = "share of the change of torques that no load explains, as with two axes exchanged"
    return PayloadCheck(name, share, _MOST_UNEXPLAINED, "")


def lever_check(rigid: Rigid12, base_R_sensor: Rotation, *, on_top: bool) -> PayloadCheck:
    """All torques with the other sign than the forces: a hanging load seems to stand on the sensor.

    ``on_top`` says that it does stand there. ``base_R_sensor`` holds the poses of the fit.
    """
    above_m = _above_m(rigid, base_R_sensor)
    away_m = -above_m if on_top else above_m
    lever_m = float(np.linalg.norm(rigid.centre_of_mass_m))
    # A file whose moments are all zero has no lever, and no sign of it either.
    away = max(0.0, away_m / lever_m) if lever_m > 0.0 else 0.0
    name = "share of the lever that points away from where the load is"
    return PayloadCheck(name, away, _MOST_AWAY, "")


def lever_words(rigid: Rigid12, base_R_sensor: Rotation) -> str:
    """What to do about a lever that points away: either the torques or the statement is wrong."""
    above_mm = _above_m(rigid, base_R_sensor) / MM
    other = "carries its load on top" if above_mm > 0.0 else "does not carry its load on top"
    do = "give" if above_mm > 0.0 else "leave out"
    return (
        f"the centre of mass is {abs(above_mm):.0f} mm {'above' if above_mm > 0.0 else 'below'} "
        "the sensor: the torques have the other sign than the forces, or their axes are turned; or "
        f"the sensor {other}. Look at the signs of mx_nm, my_nm and mz_nm in the sensor's manual "
        f"and in the file, or {do} --load-on-top"
    )


def _above_m(rigid: Rigid12, base_R_sensor: Rotation) -> float:
    """Mean height of the centre of mass over the sensor, against gravity as identified."""
    levers_m = base_R_sensor.apply(rigid.centre_of_mass_m)
    return -float(np.mean(levers_m @ np.array(rigid.base_down)))
