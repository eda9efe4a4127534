"""The discrete admittance law: a peg that gives way like a damped mass on a spring.

Law of each axis, ``M dv/dt + S v + K x = push + felt``, where ``felt`` is what the environment
exerts on the peg and ``push`` what the peg shall push with. Damping and spring are taken at the end
of the step (semi-implicit), so that neither of them can make the sampled law unstable. Source:
section 4 of the study of insertion by touch.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cellctl.geometry.pose import Array

RAMP_S = 0.3
"""Time in which a push grows from what is felt to what is wanted (section 4.2). A push that changed
at once would be a step for the loop, and the arm would jump."""


@dataclass(frozen=True, slots=True, eq=False)
class AdmittanceGains:
    """Gains of six axes; all of shape (6,)."""

    mass: Array
    """Virtual mass M in kg, and in kg·m² about the axes. It matters little as long as M/S is short
    against the dead time."""
    damping: Array
    """Damping S in N·s/m, and in N·m·s/rad about the axes."""
    spring: Array
    """Spring K in N/m, and in N·m/rad about the axes; 0 on an axis whose force is controlled."""
    follows: NDArray[np.bool_]
    """An axis that does not follow is stiff: it stays where it is."""


@dataclass(frozen=True, slots=True, eq=False)
class AdmittanceBounds:
    """What an axis may at most do; all of shape (6,), in SI units."""

    speed: Array
    acceleration: Array
    way: Array


class Admittance:
    """Displacement of the peg from its nominal pose; begins at rest, with none."""

    def __init__(self, gains: AdmittanceGains, bounds: AdmittanceBounds, period_s: float) -> None:
        self._bounds, self._period_s = bounds, period_s
        self.gains = gains
        """May be replaced at any tick: displacement and speed are kept, so nothing jumps."""
        self.velocity: Array = np.zeros(6)
        """Shape (6,), m/s and rad/s: the speed of the last displacement, after all bounds."""
        self._shift_m: Array = np.zeros(3)
        # A rotation and not a sum of rotation vectors: turns about different axes do not add up.
        self._turn = Rotation.identity()

    @property
    def displacement(self) -> Array:
        """Shift (m) and rotation vector (rad), shape (6,)."""
        return np.concatenate([self._shift_m, self._turn.as_rotvec()])

    @property
    def at_bound(self) -> NDArray[np.bool_]:
        """Shape (6,): axes that have given way as far as they may."""
        # Not exactly the bound: a rotation vector that was clipped comes back from its rotation
        # with the rounding of both conversions.
        near = np.abs(self.displacement) >= 0.999 * self._bounds.way
        return np.asarray(near & self.gains.follows)

    def step(self, push: Array, felt: Array) -> Array:
        """Displacement of the next tick; both arguments of shape (6,)."""
        gains, tick_s = self.gains, self._period_s
        # With S v and K x taken at the end of the step, M (v' - v)/T = push + felt - S v' -
        # K (x + T v'); solved for v' this is v' = (v + T/M (push + felt - K x)) / lag.
        lag = 1.0 + (tick_s * gains.damping + tick_s**2 * gains.spring) / gains.mass
        drive = push + felt - gains.spring * self.displacement
        wanted = (self.velocity + tick_s / gains.mass * drive) / lag
        wanted = np.clip(wanted, -self._bounds.speed, self._bounds.speed)
        # The acceleration last: a bound of the speed that is reached at once would be a jerk.
        return self._move(self._accelerated(wanted))

    def hold(self) -> Array:
        """The same displacement again, and half the speed for the next tick.

        This is what a tick gets that comes late (section 4.2): the arm stands for one tick, and the
        travel that was lost is not made up for.
        """
        self.velocity = self.velocity / 2
        return self.displacement

    def brake(self) -> Array:
        """Displacement of the next tick on the way to standstill."""
        return self._move(self._accelerated(np.zeros(6)))

    def _accelerated(self, wanted: Array) -> Array:
        most = self._bounds.acceleration * self._period_s
        velocity = self.velocity + np.clip(wanted - self.velocity, -most, most)
        return np.asarray(np.where(self.gains.follows, velocity, 0.0))

    def _move(self, velocity: Array) -> Array:
        tick_s, way = self._period_s, self._bounds.way
        shift_m = np.clip(self._shift_m + tick_s * velocity[:3], -way[:3], way[:3])
        # Only the correction is a rotation vector, and it is small. That of a whole attitude would
        # jump where its angle passes 180°.
        turned = Rotation.from_rotvec(tick_s * velocity[3:]) * self._turn
        turn = Rotation.from_rotvec(np.clip(turned.as_rotvec(), -way[3:], way[3:]))
        # The speed is calculated back from what was really done. Otherwise it would go on growing
        # while the axis stands at its bound (wind-up), and would have to be undone first when the
        # force turns round.
        rate = (turn * self._turn.inv()).as_rotvec() / tick_s
        self.velocity = np.concatenate([(shift_m - self._shift_m) / tick_s, rate])
        self._shift_m, self._turn = shift_m, turn
        return self.displacement


class PushRamp:
    """The push of a motion from tick to tick: begins at what is felt, so that nothing jumps."""

    def __init__(
        self, felt: Array, push: Array, period_s: float, duration_s: float = RAMP_S
    ) -> None:
        """``felt`` and ``push`` of shape (6,)."""
        # At the start push + felt is to be zero: the peg pushes with what it feels already.
        self._begin, self._end = -felt, push
        self._step = period_s / max(duration_s, period_s)
        self._share = 0.0

    def step(self) -> Array:
        """The push of the next tick, shape (6,)."""
        self._share = min(self._share + self._step, 1.0)
        return np.asarray(self._begin + self._share * (self._end - self._begin))
