"""What each depth of an insertion allows."""

from dataclasses import dataclass
from enum import Enum

from cellctl.processes.antenna_module.connector.connector import Connector


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
    entry_height_m: float = 0.5e-3
    """Above the first touch, from where on the plug moves slowly."""
    travel_m_s: float = 5e-3
    early_touch_m: float = 0.0
    """The first touch may come so much earlier than drawn: heights are uncertain."""
    entry_m_s: float = 0.07e-3
    entry_step_m: float = 0.025e-3
    """From the first touch on. So slow, and in so small steps, that a pin which slides down its
    funnel meets less than 3 N from the side before a stop that takes 250 ms takes effect, or before
    the step ends where no stop is obeyed; with a holder of 50 N/mm."""
    sliding_m_s: float = 0.4e-3
    """As slow as connectors are tested."""
    spring_rise_m: float = 0.5e-3
    """Depth over which the contact springs open, at most."""
    above_n: float = 3.0
    entry_axial_n: float = 1.2
    """Contacts that lie within 5 µm of their places reach 1.0 N in a plug that is 30 µm off; a plug
    that is 0.10 mm off begins at 1.7 N (docs/plugging.md)."""
    entry_rise_n: float = 0.08
    """By how much the axial force must exceed its own mean of the last 0.1 s: a hose that pulls
    steadily is not a contact."""
    entry_most_n: float = 3.0
    """Whatever it was before."""
    entry_side_n: float = 1.5
    entry_moment_z_n_m: float = 0.008
    """Six times the noise of a mean of three samples; a turned module shows here first."""
    sliding_side_n: float = 3.0
    moment_z_n_m: float = 0.02
    over_n: float = 10.0
    """Above ``greatest_n``: allowed at the seat."""
    centre_of_pressure_m: float = 1e-3
    least_pressure_n: float = 8.0
    """Below this axial force the centre of pressure is not certain: contacts of one lot differ by a
    quarter, and a moment good to 0.002 N·m is worth a quarter of a millimetre."""
    pressure_mean_s: float = 0.07
    """Over which force and moment are averaged for the centre of pressure. Gripper and module swing
    at about 14 Hz, and on a lever of 0.2 m a few hundredths of a newton are half a millimetre."""
    seat_rise_n: float = 10.0
    seat_within_m: float = 0.1e-3
    """The force rises by ``seat_rise_n`` within this depth at the seat."""
    seat_tolerance_m: float = 0.15e-3

    @classmethod
    def of(cls, connector: Connector) -> "InsertionLimits":
        """The limits of a drawing."""
        return cls(connector.spring_depth_m, connector.seat_depth_m, connector.force_n[1])

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
            self.centre_of_pressure_m,
        )
