"""What each depth of an insertion allows."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from cellctl.processes.antenna_module.connector.connector import Connector

_ENTRY_AXIAL_N_M = 6e3
"""Axial force at the entry for each metre of the radius that a funnel takes; 1.2 N for a
micro-D."""
_ENTRY_TURNING_N, _TURNING_N = 1.75, 4.4
"""Side force on the contact that is farthest from the middle, as a moment about z: 0.008 and
0.02 N·m for a micro-D, the first six times the noise of a mean of three samples. A turned module
shows there first."""
_FORCE_SPREAD = 0.25 / 3**0.5
"""Contacts of one lot differ evenly by a quarter up and down; this is one sigma."""
_TILT_RAD = float(np.radians(0.15))
"""Tilt of a plug in the gripper, one sigma."""
_SIGMAS = 4.0
"""Half width of the band of good insertions, in standard deviations."""


class InsertionPhase(Enum):
    """Where the plug is."""

    ABOVE = "above"
    """Nothing may be felt."""
    ENTRY = "entry"
    """From just above the first touch to where the contact springs begin. Axial force here means
    that a pin stands on the face or at a wall, and nothing later can tell that any more."""
    SLIDING = "sliding"
    """Springs, sliding, and the seat."""


@dataclass(frozen=True, slots=True)
class PhaseLimits:
    """Bounds of one phase; N, N·m, m/s."""

    phase: InsertionPhase
    speed_m_s: float
    axial_n: float
    side_n: float
    moment_z_n_m: float
    centre_of_pressure_m: float
    """Distance of the centre of pressure from the middle of the connector."""


@dataclass(frozen=True, slots=True)
class InsertionLimits:
    """Depths and forces of one connector, for a holder of at most 50 N/mm sideways."""

    spring_depth_m: float
    seat_depth_m: float
    greatest_n: float
    """Axial force of a good plugging, at most."""
    contacts: int
    spread_m: float
    """Spread of the contacts about the middle of the connector, rms."""
    entry_axial_n: float
    """A plug that is off by half of what the funnels take begins at 1.4 times as much, a good one
    stays below it; B11 and B12 in docs/plugging-figures.md."""
    entry_moment_z_n_m: float
    moment_z_n_m: float
    entry_height_m: float = 0.5e-3
    """Height above the first touch from where on the plug moves slowly."""
    travel_m_s: float = 5e-3
    early_touch_m: float = 0.0
    """How much earlier or later than drawn touch and springs may come: heights are uncertain. What
    ``spring_depth_m`` says is then earlier by as much."""
    entry_m_s: float = 0.07e-3
    entry_step_m: float = 0.025e-3
    """From the first touch on. So slow, and in so small steps, that a pin which slides down its
    funnel meets less than 3 N from the side before a stop that takes 250 ms takes effect, or before
    the step ends where no stop is obeyed; with a holder of 50 N/mm."""
    sliding_m_s: float = 0.4e-3
    """Speed while the contacts slide: as slow as connectors are tested."""
    spring_rise_m: float = 0.5e-3
    """Depth over which the contact springs open, at most."""
    above_n: float = 3.0
    entry_rise_n: float = 0.08
    """Rise of the axial force over its own mean of the last 0.1 s that counts as a contact. A hose
    that pulls steadily makes no rise."""
    entry_most_n: float = 3.0
    """Whatever it was before."""
    entry_side_n: float = 1.5
    sliding_side_n: float = 3.0
    over_n: float = 10.0
    """How much more than ``greatest_n`` is allowed at the seat."""
    centre_of_pressure_m: float = 1e-3
    """Least limit of the centre of pressure; it is greater for connectors so wide that good ones
    need it."""
    lever_error_m: float = 0.0
    """Error of the centre of pressure, whatever the connector is."""
    least_pressure_n: float = 8.0
    """Axial force below which the centre of pressure is not certain: contacts of one lot differ by
    a quarter, and a moment good to 0.002 N·m is worth a quarter of a millimetre."""
    pressure_mean_s: float = 0.07
    """Time over which force and moment are averaged for the centre of pressure. Gripper and module
    swing at about 14 Hz, and on a lever of 0.2 m a few hundredths of a newton are half a
    millimetre."""
    seat_rise_n: float = 10.0
    seat_within_m: float = 0.1e-3
    """The force rises by ``seat_rise_n`` within this depth at the seat."""
    seat_tolerance_m: float = 0.15e-3

    @classmethod
    def of(cls, connector: Connector) -> "InsertionLimits":
        """The limits of a drawing."""
        reach_m = np.linalg.norm(connector.positions_m, axis=1)
        farthest_m = float(reach_m.max())
        return cls(
            spring_depth_m=connector.spring_depth_m,
            seat_depth_m=connector.seat_depth_m,
            greatest_n=connector.force_n[1],
            contacts=len(reach_m),
            spread_m=float(np.sqrt(np.mean(reach_m**2))),
            entry_axial_n=_ENTRY_AXIAL_N_M * connector.capture_m,
            entry_moment_z_n_m=_ENTRY_TURNING_N * farthest_m,
            moment_z_n_m=_TURNING_N * farthest_m,
        )

    @property
    def springs_begin_m(self) -> float:
        """Depth at which the contact springs begin at the latest."""
        return self.spring_depth_m + 2 * self.early_touch_m

    def phase_at(self, depth_m: float) -> InsertionPhase:
        """The phase at a depth."""
        if depth_m < -self.entry_height_m:
            return InsertionPhase.ABOVE
        return InsertionPhase.ENTRY if depth_m < self.spring_depth_m else InsertionPhase.SLIDING

    def at(self, depth_m: float) -> PhaseLimits:
        """Speed and bounds at a depth."""
        infinite = float("inf")
        phase = self.phase_at(depth_m)
        if phase is InsertionPhase.ABOVE:
            above = self.above_n
            return PhaseLimits(phase, self.travel_m_s, above, above, infinite, infinite)
        if phase is InsertionPhase.ENTRY:
            return PhaseLimits(
                phase,
                self.entry_m_s,
                self.entry_most_n,
                self.entry_side_n,
                self.entry_moment_z_n_m,
                infinite,
            )
        return PhaseLimits(
            phase,
            self.sliding_m_s,
            self.greatest_n + self.over_n,
            self.sliding_side_n,
            self.moment_z_n_m,
            self._centre_of_pressure_m(depth_m),
        )

    def _centre_of_pressure_m(self, depth_m: float) -> float:
        """How far from the middle a good lot may press at a depth, four sigma."""
        # A tilted plug opens the springs of one end sooner, which counts the more the less they
        # are open; and no lot presses so hard that the centre is judged before that.
        least_m = self.spring_rise_m * self.least_pressure_n / self.greatest_n
        open_m = min(max(depth_m - self.springs_begin_m, least_m), self.spring_rise_m)
        by_tilt_m = _TILT_RAD * self.spread_m**2 / open_m
        by_forces_m = _FORCE_SPREAD * self.spread_m / np.sqrt(self.contacts)
        good_m = float(_SIGMAS * np.hypot(by_tilt_m, by_forces_m))
        return max(self.centre_of_pressure_m, good_m) + self.lever_error_m
