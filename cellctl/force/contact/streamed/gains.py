"""Gains of the admittance from stiffness and dead time of the loop, and when to refuse it.

A contact with stiffness k along w = (n, p × n) loads every controlled axis at once, and the loads
add up: the sampled loop is stable while the sum of ``k w_i² θ / S_i`` stays below π/2, and hardly
overshoots at 2/3. So an axis that shares a contact with others needs ``S_i = 1.5 n k w_i² θ``.
Source: section 4.1 of the study of insertion by touch.
"""

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from cellctl.errors.streamed_contact import LoopNotMeasured, LoopTooSlow, LoopUnstable
from cellctl.geometry.pose import Array

_DAMPING_RATIO = 1.5
_GREATEST_LOAD = 0.70
_SLOWEST_M_S = 0.05e-3
_MASS_KG = 10.0
_MASS_SHARE = 0.1


@dataclass(frozen=True, slots=True)
class LoopFigures:
    """What was measured of a cell with its tool; upper bounds."""

    stiffness_n_m: float
    """Of arm and contact in series."""
    dead_time_s: float
    """From a force at the tip to a motion of the tip in answer."""

    def __post_init__(self) -> None:
        """Raise ``LoopNotMeasured`` for figures that cannot be measurements."""
        for name, value in (
            ("stiffness (N/m)", self.stiffness_n_m),
            ("dead time (s)", self.dead_time_s),
        ):
            if not (isfinite(value) and value > 0):
                raise LoopNotMeasured(f"{name} is {value!r}")

    @property
    def loop_n_s_m(self) -> float:
        """Stiffness times dead time."""
        return self.stiffness_n_m * self.dead_time_s


def levers(lever_m: float) -> Array:
    """Weights w (6,) of a contact at the rim: 1 for a shift, the radius of the peg for a turn."""
    return np.array([1.0, 1.0, 1.0, lever_m, lever_m, lever_m])


def damping(figures: LoopFigures, weights: Array, axes: int) -> Array:
    """S of each axis when one contact loads ``axes`` of them; as ``weights``."""
    return _DAMPING_RATIO * axes * figures.loop_n_s_m * weights**2


def virtual_mass(figures: LoopFigures, weights: Array) -> Array:
    """M of each axis, as ``weights``; the same at the rim for a shift and a turn."""
    # M/S stays short against the dead time, or the mass would add to it.
    light_kg = _MASS_SHARE * _DAMPING_RATIO * figures.loop_n_s_m * figures.dead_time_s
    return np.asarray(min(_MASS_KG, light_kg) * weights**2)


def contact_load(
    figures: LoopFigures, lever_m: float, damping_s: Array, follows: NDArray[np.bool_]
) -> float:
    """Greatest sum of ``k w_i² θ / S_i`` for a contact at the rim; arrays of shape (6,).

    The direction of a contact has length 1 and its moment at most that of the lever, so it loads
    the axes that follow no more than the weakest of each three.
    """
    yielding = np.where(follows, figures.loop_n_s_m * levers(lever_m) ** 2 / damping_s, 0.0)
    return float(yielding[:3].max() + yielding[3:].max())


def check_load(load: float) -> None:
    """Raise ``LoopUnstable`` for a load that leaves too little margin."""
    if load > _GREATEST_LOAD:
        raise LoopUnstable(
            f"sum of k w^2 theta / S is {load:.2f}, at most {_GREATEST_LOAD:.2f} is allowed"
        )


def check_press(figures: LoopFigures, press_n: float, damping_n_s_m: float) -> None:
    """Raise ``LoopTooSlow`` when a press would hardly move the arm."""
    speed_m_s = press_n / damping_n_s_m
    if speed_m_s < _SLOWEST_M_S:
        raise LoopTooSlow(
            f"{press_n:.1f} N move the arm at {speed_m_s * 1e3:.3f} mm/s only (S "
            f"{damping_n_s_m:.3g} N s/m from k {figures.stiffness_n_m:.3g} N/m and "
            f"{figures.dead_time_s * 1e3:.0f} ms), {_SLOWEST_M_S * 1e3:.2f} mm/s are needed"
        )


def check_speed(speed_m_s: float, damping_n_s_m: float, limit_n: float) -> None:
    """Raise ``LoopUnstable`` when giving way at full speed takes over half of the force limit."""
    needed_n = damping_n_s_m * speed_m_s
    if needed_n > 0.5 * limit_n:
        raise LoopUnstable(
            f"{needed_n:.1f} N are needed to give way at {speed_m_s * 1e3:.2f} mm/s, more than "
            f"half of the limit of {limit_n:.0f} N"
        )
