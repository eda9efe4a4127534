"""All figures of a mating in SI, from the recipe and from commissioning."""

from dataclasses import dataclass, field

import numpy as np

from cellctl.force.contact.seat import SeatLimits, seat_limits
from cellctl.force.contact.touch_detector import Cusum

FAST_LIMIT_N = 20.0
"""Filtered force at which the fast travel takes itself for a contact."""


@dataclass(frozen=True, slots=True)
class PinSettings:
    """Pins that enter the deck before it sits, and how far it may give way to them."""

    engagement_m: float
    """They are met so far above the seat."""
    stiffness_n_m: float = 1e6
    """Upper bound along the approach, arm and pins in series: the arm's own. What was measured at
    the seat says nothing about a pin."""
    contact_stiffness_n_m: float = 4e7
    """Of the pins alone, upper bound: two of steel that the deck meets at once."""
    compliant: bool = True
    """Give way to them; else they are only approached slowly."""
    greatest_travel_m: float = 2e-4
    greatest_yaw_rad: float = float(np.deg2rad(0.03))
    lateral_stiffness_n_m: float = 1e6
    """Upper bound of what is felt across the approach: the arm's own."""
    yaw_stiffness_n_m_rad: float = 3e5
    dead_band_n: float = 3.0
    dead_band_n_m: float = 1.5
    greatest_step_m: float = 5e-5
    greatest_step_rad: float = float(np.deg2rad(0.005))
    search_radius_m: float = 0.0
    """Places so far round the stand-off are tried for pins that stand on the deck; 0: none is."""
    catch_m: float = 1e-4
    """A pin so far beside its hole still enters."""


@dataclass(frozen=True, slots=True)
class MatingSettings:
    """Constants of a mating; the defaults are those of the shipped recipe and its payload.

    Latency and stiffness have none. What follows from another figure is a property.
    """

    stop_latency_s: float
    """Upper bound from the stop-latency procedure."""
    stiffness_n_m: float
    """Arm and contact in series, upper bound."""
    # Upper end of the range in which the mating is tried out (1e5 to 1e7 N/m, docs/mating.md, "How
    # it is tested").
    contact_stiffness_n_m: float = 1e7
    """Deck on frame alone, upper bound: only the impact term needs it."""
    moving_mass_kg: float = 200.0
    """Everything that hangs on the force sensor."""
    deceleration_m_s2: float = 0.1
    """The least deceleration of a stop."""

    target_force_n: float = 35.0
    """F_t of the paper: complete at or above it."""
    abort_force_n: float = 45.0
    """Filtered force at which the guard stops the robot."""
    limit_force_n: float = 50.0
    """True contact force that must never be exceeded."""
    tare_uncertainty_n: float = 1.5
    force_sigma_n: float = 0.3
    """Standard deviation of a reading at standstill."""
    touch: Cusum = field(default_factory=Cusum)
    sample_period_s: float = 1e-3
    stale_s: float = 5e-3
    """Silence of the sensor after which the guard stops."""
    flange_age_s: float = 0.1
    """Age of the flange pose at which the guard stops."""
    filter_delay_s: float = 5e-3

    fast_speed_m_s: float = 5e-3
    acceleration_m_s2: float = 0.02
    fast_limit_n: float = FAST_LIMIT_N
    """Filtered force that ends the fast travel: inertia at ``acceleration_m_s2`` and no more."""
    greatest_past_m: float = 5e-4
    """No commanded target lies further past the expected contact."""
    window_m: float = 3e-4
    """Greatest half width of the contact window."""
    least_window_m: float = 1e-4
    # With 3 sigma, about one good contact in 400 would lie outside and be a fault.
    coverage: float = 4.0
    """Half width of the contact window in standard deviations."""
    clear_margin_m: float = 2e-4
    """Slow travel begins this much before the window."""
    travel_sigma_m: float = 1e-5
    """Relative accuracy of the arm over the stand-off distance."""
    thickness_sigma_m: float = 1.2e-5
    half_size_m: tuple[float, float] = (0.5, 0.25)
    """Half length and half width of the mating face: tilt makes an edge touch first."""
    # The job programs offer steps of 0.5 mm (STEPMAX in docs/protocols/sjl-1.md).
    greatest_segment_m: float = 4e-4
    """Longest single move; below the step limit of the controller."""

    settle_s: float = 0.5
    settle_timeout_s: float = 5.0
    settle_sigma: tuple[float, float] = (3.0, 2.0)
    """Scatter of force (N) and moment (N·m) that counts as steady; the moment about the deck has
    the noise of the lateral force on its lever."""
    plausible: tuple[float, float] = (80.0, 40.0)
    """Untared force (N) and moment (N·m) at the stand-off that compensation can leave."""
    tare_s: float = 0.5

    # Backward Euler converges with this damping up to twice the expected stiffness; explicit Euler
    # would need S > T k / 2, about 2.7e5 N·s/m (docs/mating.md, "The creep").
    creep_damping_n_s_m: float = 5e4
    creep_mass_kg: float = 20.0
    # A move takes effect once in this time (docs/mating.md, "The creep").
    step_period_s: float = 0.6
    step_speed_m_s: float = 2e-4
    step_settle_s: float = 0.15
    """Lets the hanging mass calm down before a reading."""
    reading_s: float = 0.2
    smallest_step_m: float = 1e-6
    greatest_step_m: float = 1e-4
    step_sigma_m: float = 3e-6
    """Standard deviation of the length of a short move: what the arm adds to every single one."""
    max_creep_steps: int = 40
    hold_s: float = 0.5
    release_low_n: float = 10.0
    release_high_n: float = 20.0

    pins: PinSettings | None = None
    max_lateral_n: float = 25.0
    max_moment_n_m: float = 25.0
    # Out of contact also where it is soft: at 1e5 N/m, 50 N are 0.5 mm.
    back_off_m: float = 2e-3
    back_off_speed_m_s: float = 1e-3
    stand_off_tolerance: tuple[float, float] = (2e-4, float(np.deg2rad(0.02)))
    """Distance (m) and angle (rad) the robot may be away from the planned stand-off."""

    @property
    def approach_stiffness_n_m(self) -> float:
        """Arm in series with what the slow travel may meet, upper bound: pins come before the
        seat."""
        return max(self.stiffness_n_m, self.pins.stiffness_n_m if self.pins else 0.0)

    @property
    def approach_contact_stiffness_n_m(self) -> float:
        """The same without the arm, for the impact."""
        pins_n_m = self.pins.contact_stiffness_n_m if self.pins else 0.0
        return max(self.contact_stiffness_n_m, pins_n_m)

    @property
    def touch_peak_n(self) -> float:
        """Predicted peak of the touch at the approach speed; the creep does the rest."""
        return self.target_force_n

    @property
    def seat(self) -> SeatLimits:
        """What the deck is judged by while the force is held."""
        return seat_limits(
            target_force_n=self.target_force_n,
            abort_force_n=self.abort_force_n,
            max_lateral_n=self.max_lateral_n,
            half_size_m=self.half_size_m,
        )
