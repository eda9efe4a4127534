"""All figures of a mating in SI, from the recipe and from commissioning."""

from dataclasses import dataclass, field

import numpy as np

from cellctl.force.contact.seat import SeatLimits, seat_limits
from cellctl.force.contact.touch_detector import Cusum

FAST_LIMIT_N = 20.0
"""Filtered force at which the fast travel counts as a contact: five times the inertia of 200 kg at
0.02 m/s², and below the greatest side force."""


@dataclass(frozen=True, slots=True)
class PinSettings:
    """Pins that enter the deck before it sits, and how far it may give way to them."""

    engagement_m: float
    """Height above the seat at which the deck meets the pins."""
    stiffness_n_m: float = 1e6
    """Upper bound along the approach, arm and pins in series: the arm's own. What was measured at
    the seat says nothing about a pin."""
    contact_stiffness_n_m: float = 4e7
    """Of the pins alone, upper bound: two of steel that the deck meets at once (docs/mating.md,
    "Pins")."""
    compliant: bool = True
    """Give way to them; else they are only approached slowly."""
    greatest_travel_m: float = 2e-4
    """Bound of the whole displacement: a deck that is farther from its pins was measured
    wrongly."""
    greatest_yaw_rad: float = float(np.deg2rad(0.03))
    """The same for the yaw: 0.26 mm at the end of a face that is 1 m long."""
    lateral_stiffness_n_m: float = 1e6
    """Upper bound of what is felt across the approach: the arm's own."""
    yaw_stiffness_n_m_rad: float = 3e5
    """The same about the approach: 1e6 N/m on a lever of 0.55 m. Too high only makes more moves."""
    dead_band_n: float = 3.0
    """Side force that is left alone: twice what the tare may leave, and friction."""
    dead_band_n_m: float = 1.5
    """The same for the moment about the approach: 3 N on the half length of the face."""
    greatest_step_m: float = 5e-5
    """Longest single move across: even the wrong way it makes 50 N at most at 1e6 N/m."""
    greatest_step_rad: float = float(np.deg2rad(0.005))
    """The same for the yaw: 0.04 mm at the end of a face that is 1 m long."""
    search_radius_m: float = 0.0
    """Radius round the stand-off in which places are tried when pins stand on the deck; 0: none."""
    catch_m: float = 1e-4
    """A pin that is this far beside its hole still enters."""


@dataclass(frozen=True, slots=True)
class MatingSettings:
    """Constants of a mating; the defaults are those of the shipped recipe and its payload.

    Latency and stiffness have none. What follows from another figure is a property.
    """

    stop_latency_s: float
    """Upper bound from the stop-latency procedure."""
    stiffness_n_m: float
    """Arm and contact in series, upper bound."""
    contact_stiffness_n_m: float = 1e7
    """Deck on frame alone, upper bound: only the impact term needs it. It is the upper end of the
    range in which the mating is tried out (1e5 to 1e7 N/m, docs/mating.md, "How it is tested")."""
    moving_mass_kg: float = 200.0
    """Everything that hangs on the force sensor."""
    deceleration_m_s2: float = 0.1
    """The least deceleration of a stop. At the approach speed its term of the peak is nothing
    (docs/mating.md, "The speed"), so its exact value does not matter."""

    target_force_n: float = 35.0
    """F_t of the paper: complete at or above it."""
    abort_force_n: float = 45.0
    """Filtered force at which the guard stops the robot."""
    limit_force_n: float = 50.0
    """True contact force that must never be exceeded."""
    tare_uncertainty_n: float = 1.5
    """F_tare of the speed's formula: what tare, drift and pose may leave of the force."""
    force_sigma_n: float = 0.3
    """Standard deviation of a reading at standstill: 2.5 N of noise of a sample, over the 200
    samples of a reading, and the rest of the swing."""
    touch: Cusum = field(default_factory=Cusum)
    sample_period_s: float = 1e-3
    stale_s: float = 5e-3
    """Silence of the sensor after which the guard stops."""
    flange_age_s: float = 0.1
    """Age of the flange pose at which the guard stops."""
    filter_delay_s: float = 5e-3
    """Time constant of the guard's low-pass (``guard.limits.DEFAULT_FILTER_S``)."""

    fast_speed_m_s: float = 5e-3
    """Speed while contact is excluded. What vision has not seen is met at it: docs/mating.md, "What
    if the stop is not obeyed"."""
    acceleration_m_s2: float = 0.02
    """So low that the inertia of 200 kg, 4 N, stays far below ``fast_limit_n``."""
    fast_limit_n: float = FAST_LIMIT_N
    """Filtered force that ends the fast travel: inertia at ``acceleration_m_s2`` and no more."""
    greatest_past_m: float = 5e-4
    """No commanded target lies further past the expected contact."""
    window_m: float = 3e-4
    """Greatest half width of the contact window."""
    least_window_m: float = 1e-4
    """Least half width of it: a covariance that is too small must not make a good contact a
    fault."""
    coverage: float = 4.0
    """Half width of the contact window in standard deviations. With three, about one good contact
    in 400 would lie outside and be a fault."""
    clear_margin_m: float = 2e-4
    """Slow travel begins this much before the window: an arm at ``fast_speed_m_s`` that brakes with
    ``acceleration_m_s2`` comes to rest at its target, so this is for the error of its pose."""
    travel_sigma_m: float = 1e-5
    """Relative accuracy of the arm over the stand-off distance."""
    thickness_sigma_m: float = 1.2e-5
    """Standard deviation of the deck's thickness: a tolerance of ±0.02 mm over the root of
    three."""
    half_size_m: tuple[float, float] = (0.5, 0.25)
    """Half length and half width of the mating face: tilt makes an edge touch first."""
    greatest_segment_m: float = 4e-4
    """Longest single move; below the step limit of the controller, whose job programs offer 0.5 mm
    (STEPMAX in docs/protocols/sjl-1.md)."""

    settle_s: float = 0.5
    """The wrench has to be steady for this time before the tare: five swings of the hanging
    mass."""
    settle_timeout_s: float = 5.0
    """A mass that still swings then is a fault. It swings for a second or two after a move."""
    settle_sigma: tuple[float, float] = (3.0, 2.0)
    """Scatter of force (N) and moment (N·m) that counts as steady; the moment about the deck has
    the noise of the lateral force on its lever."""
    plausible: tuple[float, float] = (80.0, 40.0)
    """Untared force (N) and moment (N·m) at the stand-off that compensation can leave."""
    tare_s: float = 0.5
    """Length of the tare: the mean of 500 samples at 1 kHz has a twentieth of the noise of one."""

    creep_damping_n_s_m: float = 5e4
    """S. Backward Euler converges with it up to twice the expected stiffness; explicit Euler would
    need S > T k / 2, about 2.7e5 N·s/m (docs/mating.md, "The creep")."""
    creep_mass_kg: float = 20.0
    """M, virtual. M/T is a thousandth of S, so its exact value does not matter."""
    step_period_s: float = 0.6
    """T: a move takes effect once in this time, which is that of move, settling and reading
    (docs/mating.md, "The creep")."""
    step_speed_m_s: float = 2e-4
    """Speed of a single move in contact. A move is so short that its length bounds the force."""
    step_settle_s: float = 0.15
    """Lets the hanging mass calm down before a reading: one or two of its swings."""
    reading_s: float = 0.2
    """Length of a reading at standstill, two swings of the hanging mass: their mean is the
    force."""
    smallest_step_m: float = 1e-6
    """A shorter step changes no force that could be read: at 1e6 N/m it makes 1 N."""
    greatest_step_m: float = 1e-4
    """Longest step of the creep where the contact is still soft."""
    step_sigma_m: float = 3e-6
    """Standard deviation of the length of a short move: what the arm adds to every single one."""
    max_creep_steps: int = 40
    """Steps after which a creep is given up, and bound of every loop in contact. A creep that
    converges ends long before."""
    hold_s: float = 0.5
    """Time for which the force is held before the seat is judged."""
    release_low_n: float = 10.0
    release_high_n: float = 20.0
    """Between these the force is left for fastening."""

    pins: PinSettings | None = None
    max_lateral_n: float = 25.0
    """Greatest force across the approach."""
    max_moment_n_m: float = 25.0
    """Greatest moment about each axis: above what a deck that rests on an edge makes, 24 N·m
    (docs/mating.md, "The seat")."""
    back_off_m: float = 2e-3
    """Out of contact also where it is soft: at 1e5 N/m, 50 N are 0.5 mm."""
    back_off_speed_m_s: float = 1e-3
    """Speed of it after the first stretch, when a deck that is held would have been noticed."""
    stand_off_tolerance: tuple[float, float] = (2e-4, float(np.deg2rad(0.02)))
    """Distance (m) and angle (rad) the robot may be away from the planned stand-off: four times
    the thresholds to which the deck was corrected there."""

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
