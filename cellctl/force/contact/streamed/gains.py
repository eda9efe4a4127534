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
"""S over ``n k w² θ``. Simulated on a stiff contact, a step of the push overshoots by 6 to 8 % and
settles in 3.5 dead times with 1.5. With 0.7 it overshoots by half and more, from 2 on not at
all."""
_GREATEST_LOAD = 0.70
"""The gains below make a load of 2/3; above 0.70 the study refuses to engage."""
_SLOWEST_M_S = 0.05e-3
"""A press that moves the arm more slowly than this is refused (section 4.1): 1 mm would take
20 s."""
_MASS_KG = 10.0
"""Greatest virtual mass. By the study it hardly matters between 5 and 50 kg."""
_MASS_SHARE = 0.1
"""Share of the dead time that M/S may have. The study asks for M/S ≪ θ."""


@dataclass(frozen=True, slots=True)
class LoopFigures:
    """What was measured of a cell with its tool; upper bounds."""

    stiffness_n_m: float
    """Stiffness of arm and contact in series."""
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
        """k θ, stiffness times dead time: the least damping that the loop could have, but for a
        factor. Every gain below is a multiple of it."""
        return self.stiffness_n_m * self.dead_time_s


def levers(lever_m: float) -> Array:
    """Weights w, shape (6,), of a contact at the rim of the peg, ``lever_m`` from its axis.

    They are 1 for a shift and the lever for a turn, since a force at the rim turns the peg with it.
    """
    return np.array([1.0, 1.0, 1.0, lever_m, lever_m, lever_m])


def damping(figures: LoopFigures, weights: Array, axes: int) -> Array:
    """S of each axis, shape as ``weights``, when one contact loads ``axes`` of them at a time."""
    return _DAMPING_RATIO * axes * figures.loop_n_s_m * weights**2


def virtual_mass(figures: LoopFigures, weights: Array) -> Array:
    """M of each axis, shape as ``weights``: a shift and a turn feel the same mass at the rim."""
    # M/S stays short against the dead time. It is a lag like the dead time, and would need more
    # damping.
    light_kg = _MASS_SHARE * _DAMPING_RATIO * figures.loop_n_s_m * figures.dead_time_s
    return np.asarray(min(_MASS_KG, light_kg) * weights**2)


def contact_load(
    figures: LoopFigures, lever_m: float, damping_s: Array, follows: NDArray[np.bool_]
) -> float:
    """Greatest sum of ``k w_i² θ / S_i`` for any contact at the rim; arrays of shape (6,).

    The direction of a contact has length 1, so however it lies, its sum over the three shifts is no
    greater than the term of the shift with the least damping. Its moment is at most the lever, and
    the same holds for the three turns. Both together are the bound. Axes that do not follow add
    nothing: no motion answers to a force on them.
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
    """Raise ``LoopUnstable`` when giving way at full speed takes over half of the force limit.

    A damper resists its own motion: pushed aside at ``speed_m_s`` the peg answers with ``S v``. The
    other half of the limit is left to the contact that pushes.
    """
    needed_n = damping_n_s_m * speed_m_s
    if needed_n > 0.5 * limit_n:
        raise LoopUnstable(
            f"{needed_n:.1f} N are needed to give way at {speed_m_s * 1e3:.2f} mm/s, more than "
            f"half of the limit of {limit_n:.0f} N"
        )
