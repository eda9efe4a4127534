"""Lateral compliance: small moves across the approach that give way to the side force of pins.

A pin that meets the chamfer of its hole pushes the part sideways. An arm that gives way in that
direction lets the pin in; a stiff one presses the chamfer until the force limit stops it.

Law, an admittance for each of x, y and yaw of the part: ``S dq/dt = F``, where F is the force of
the counterpart on the part. As in ``creep`` a move starts and ends at rest and takes effect once
per period T, and the force of the next instant is taken into the law (``F(q + d) = F(q) − k d``,
backward Euler):

    d = T F / (S + T k) = g F / k          g = 1 / (1 + S / (T k))

With k an upper bound of the stiffness of arm and contact in series, a move never overshoots. There
is no move along the approach, none beyond the total travel, and none for a force within the dead
band: that may be what the tare has left, or friction.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class LateralOffset:
    """Displacement of the part across the approach, in its own axes at the stand-off."""

    x_m: float = 0.0
    y_m: float = 0.0
    yaw_rad: float = 0.0

    @property
    def distance_m(self) -> float:
        """Length of the displacement, without the yaw."""
        return float(np.hypot(self.x_m, self.y_m))

    def plus(self, step: "LateralOffset") -> "LateralOffset":
        """The sum; yaw angles are so small that their order does not matter."""
        return LateralOffset(self.x_m + step.x_m, self.y_m + step.y_m, self.yaw_rad + step.yaw_rad)

    def to(self, target: "LateralOffset") -> "LateralOffset":
        """The step that leads from this displacement to another one."""
        return LateralOffset(
            target.x_m - self.x_m, target.y_m - self.y_m, target.yaw_rad - self.yaw_rad
        )


NO_OFFSET = LateralOffset()


@dataclass(frozen=True, slots=True)
class ComplianceLaw:
    """Constants of the lateral and yaw compliance."""

    stiffness_n_m: float
    """k: upper bound across the approach. The arm's own stiffness is one, since arm and contact act
    in series."""
    yaw_stiffness_n_m_rad: float
    damping_n_s_m: float
    """S across the approach; that of the yaw is in proportion to its stiffness."""
    period_s: float
    """T: the time that one move takes altogether."""
    dead_band_n: float
    dead_band_n_m: float
    greatest_step_m: float
    greatest_step_rad: float
    greatest_travel_m: float
    """Bound of the total displacement from the stand-off."""
    greatest_yaw_rad: float
    smallest_step_m: float = 1e-6
    """A shorter move changes no force that could be read: at 1e6 N/m it makes less than 1 N."""
    smallest_step_rad: float = 2e-6
    """The same for the yaw: 1 µm at the end of a face that is 1 m long."""

    @property
    def gain(self) -> float:
        """g: the share of the distance to zero force that one move goes."""
        return 1.0 / (1.0 + self.damping_n_s_m / (self.period_s * self.stiffness_n_m))


def pressed(law: ComplianceLaw, wrench: Array) -> bool:
    """True when the force or moment across the approach is beyond its dead band.

    ``wrench`` is that of the counterpart on the part, in the axes of the part, shape (6,).
    """
    across_n = float(np.hypot(wrench[0], wrench[1]))
    return across_n > law.dead_band_n or abs(float(wrench[5])) > law.dead_band_n_m


def next_move(law: ComplianceLaw, so_far: LateralOffset, wrench: Array) -> LateralOffset | None:
    """The next move away from the force; None when it would be too small to make.

    ``wrench`` is that of the counterpart on the part, read at standstill, in the axes of the part,
    shape (6,); ``so_far`` the displacement of all moves before.
    """
    shift_m = _shift(law, so_far, wrench[:2])
    yaw_rad = _yaw(law, so_far.yaw_rad, float(wrench[5]))
    if np.hypot(*shift_m) < law.smallest_step_m and abs(yaw_rad) < law.smallest_step_rad:
        return None
    return LateralOffset(float(shift_m[0]), float(shift_m[1]), yaw_rad)


def _shift(law: ComplianceLaw, so_far: LateralOffset, across_n: Array) -> Array:
    size_n = float(np.hypot(*across_n))
    # Below the dead band the reading is mostly tare and friction: following it would let the part
    # wander.
    if size_n <= law.dead_band_n:
        return np.zeros(2)
    step_m = across_n / size_n * min(law.gain * size_n / law.stiffness_n_m, law.greatest_step_m)
    here_m = np.array([so_far.x_m, so_far.y_m])
    target_m = here_m + step_m
    distance_m = float(np.hypot(*target_m))
    if distance_m > law.greatest_travel_m:
        # Shortened towards the stand-off instead of clipped per axis, so that the bound is a circle
        # and the part slides along it.
        target_m *= law.greatest_travel_m / distance_m
    return np.asarray(target_m - here_m)


def _yaw(law: ComplianceLaw, so_far_rad: float, moment_n_m: float) -> float:
    if abs(moment_n_m) <= law.dead_band_n_m:
        return 0.0
    step_rad = law.gain * moment_n_m / law.yaw_stiffness_n_m_rad
    step_rad = float(np.clip(step_rad, -law.greatest_step_rad, law.greatest_step_rad))
    bound_rad = law.greatest_yaw_rad
    return float(np.clip(so_far_rad + step_rad, -bound_rad, bound_rad)) - so_far_rad
