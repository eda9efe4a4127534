"""What a mating reports while it runs and when it ends."""

from dataclasses import dataclass
from enum import Enum

from cellctl.force.contact.approach import ApproachSpeed, ContactWindow
from cellctl.force.contact.commissioning import StiffnessEstimate
from cellctl.force.contact.compliance import LateralOffset
from cellctl.force.contact.curve import CurveStatistics, ForceCurve
from cellctl.force.contact.seat import SeatVerdict
from cellctl.geometry.pose import Array


class MatingPhase(Enum):
    """The phases of a mating."""

    TARE = "tare at stand-off"
    FAST = "fast travel"
    SLOW = "guarded travel"
    CREEP = "creep to force"
    GIVE_WAY = "give way to pins"
    SEARCH = "look for the holes of pins"
    HOLD = "hold"
    RELEASE = "relax"
    BACK_OFF = "back off"
    ENDED = "ended"


@dataclass(frozen=True, slots=True)
class MatingProgress:
    """Told to the caller at every phase and step."""

    phase: MatingPhase
    travel_m: float
    force_n: float
    """Along the approach; NaN before the tare."""
    message: str = ""
    curve: ForceCurve | None = None
    """The whole force curve; only with ``ENDED``, also when the mating failed."""


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """Mean wrench at standstill."""

    time_s: float
    travel_m: float
    wrench: Array
    """Shape (6,), deck frame."""
    sigma: Array
    """Shape (6,): scatter of the samples."""

    @property
    def force_n(self) -> float:
        """Along the approach; positive when the frame pushes back."""
        return float(self.wrench[2])


@dataclass(frozen=True, slots=True)
class GivingWay:
    """One move across the approach."""

    reading: Reading
    """The reading before the move."""
    move: LateralOffset
    total: LateralOffset
    """Displacement from the stand-off after the move."""
    searched: bool = False
    """Whether it gave way not by what was felt, but to the next place of a search."""


@dataclass(frozen=True, slots=True, eq=False)
class Tare:
    """What compensation left at the stand-off, in the deck frame."""

    mean: Array
    sigma: Array


class MatingOutcome(Enum):
    """The two ways in which an attempt ends without a fault."""

    SEATED = "seated"
    FALSE_SEAT = "false seat"


@dataclass(frozen=True, slots=True)
class MatingResult:
    """One attempt. Everything a record needs, without another look at the devices."""

    outcome: MatingOutcome
    window: ContactWindow
    speed: ApproachSpeed
    segment_m: float
    tare: Tare
    touch_travel_m: float
    """Travel from the stand-off at which the touch was detected."""
    touch_force_n: float
    """Standstill reading after the touch stop."""
    creep: tuple[Reading, ...]
    """Readings of the creep, oldest first."""
    stiffness: StiffnessEstimate | None
    """Stiffness from all readings in contact; None where there were too few."""
    hold: Reading
    verdict: SeatVerdict
    relaxing: tuple[Reading, ...]
    """Readings while relaxing, oldest first; empty for a false seat."""
    gave_way: tuple[GivingWay, ...]
    """Moves across the approach, oldest first."""
    curve: ForceCurve
    statistics: CurveStatistics
    duration_s: float

    @property
    def released(self) -> Reading | None:
        """The reading after relaxing; None for a false seat."""
        return self.relaxing[-1] if self.relaxing else None
