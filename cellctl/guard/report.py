"""What the guard reports: samples, tare, trip, health."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from cellctl.errors.base import CellError
from cellctl.errors.force import (
    FlangePoseStale,
    ForceLimitExceeded,
    GuardDied,
    SensorDataInvalid,
    SensorFrozen,
    SensorRateWrong,
    SensorSaturated,
    SensorSilent,
)
from cellctl.errors.link import LinkLost
from cellctl.interfaces.ft_sensor import FtHealth

if TYPE_CHECKING:
    from cellctl.geometry.pose import Array


class TripReason(Enum):
    """Why the guard stopped the robot."""

    TOUCH = "touch"
    """The touch that mating looks for."""
    RAW_LIMIT = "raw limit"
    FILTERED_LIMIT = "filtered limit"
    SENSOR_SILENT = "sensor silent"
    SENSOR_INVALID = "sensor data invalid"
    SENSOR_SATURATED = "sensor saturated"
    SENSOR_FROZEN = "sensor frozen"
    SENSOR_RATE = "sensor rate"
    FLANGE_STALE = "flange pose stale"
    STOP_CHANNEL_LOST = "stop channel lost"
    GUARD_DIED = "guard died"
    """Seen by the daemon; the robot is stopped by its dead man."""


_FAULTS: dict[TripReason, type[CellError]] = {
    TripReason.TOUCH: ForceLimitExceeded,
    TripReason.RAW_LIMIT: ForceLimitExceeded,
    TripReason.FILTERED_LIMIT: ForceLimitExceeded,
    TripReason.SENSOR_SILENT: SensorSilent,
    TripReason.SENSOR_INVALID: SensorDataInvalid,
    TripReason.SENSOR_SATURATED: SensorSaturated,
    TripReason.SENSOR_FROZEN: SensorFrozen,
    TripReason.SENSOR_RATE: SensorRateWrong,
    TripReason.FLANGE_STALE: FlangePoseStale,
    TripReason.STOP_CHANNEL_LOST: LinkLost,
    TripReason.GUARD_DIED: GuardDied,
}


@dataclass(frozen=True, slots=True)
class GuardTrip:
    """A latched trip."""

    reason: TripReason
    time_s: float
    """Monotonic time at which the guard decided; the stop request left right after it."""
    detail: str
    """The facts in words, with units."""
    component: int | None = None
    """0 … 5 for Fx … Mz, None where it is no matter of one component."""
    value: float = 0.0
    """In N, N·m, seconds, hertz or counts, as the reason has it."""

    @property
    def touch(self) -> bool:
        """True for the touch that mating looks for."""
        return self.reason is TripReason.TOUCH

    @property
    def force(self) -> bool:
        """True for a force or moment beyond its limit."""
        return self.reason in (TripReason.RAW_LIMIT, TripReason.FILTERED_LIMIT)

    def fault(self) -> CellError:
        """The numbered fault of this trip, for whoever did not expect it."""
        return _FAULTS[self.reason](self.detail)

    def __str__(self) -> str:
        return f"{self.reason.value}: {self.detail}"


@dataclass(frozen=True, slots=True)
class GuardSample:
    """One sample as the guard published it."""

    time_s: float
    """De-jittered sample time, monotonic."""
    receive_time_s: float
    number: int
    wrench: Array
    """Shape (6,): compensated and tared, about and in the axes of the deck frame."""
    raw: Array
    """Shape (6,): sensor frame, as received."""
    flange_age_s: float
    """Age of the flange pose that the compensation used; infinite when there is none."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A stretch of samples, oldest first."""

    time_s: Array
    """Shape (n,)."""
    wrench: Array
    """Shape (n, 6), as in ``GuardSample``."""
    raw: Array
    """Shape (n, 6), as in ``GuardSample``."""
    flange_age_s: Array
    """Shape (n,)."""
    overrun: bool
    """True when samples of the stretch had been overwritten before they were read."""


@dataclass(frozen=True, slots=True)
class TareResult:
    """What the compensation had left, in the deck frame; zero from now on."""

    mean: Array
    """Shape (6,)."""
    sigma: Array
    """Shape (6,): standard deviation of the samples."""
    samples: int


@dataclass(frozen=True, slots=True)
class GuardHealth:
    """How the guard is doing."""

    alive: bool
    armed: bool = False
    latched: bool = False
    stop_channel_up: bool = False
    """Also True when the guard runs without a stop channel."""
    sensor_open: bool = False
    """False after a fault of the sensor that only a new guard ends, such as another set-up."""
    degraded: tuple[str, ...] = ()
    """Real-time measures that this PC did not permit."""
    sensor_serial: str = ""
    sensor: FtHealth = field(default_factory=FtHealth)
    sample_age_s: float = float("inf")
    flange_age_s: float = float("inf")
    late_wakeups: int = 0
    """Times the guard woke more than a millisecond late: the machine stood still."""
    peak_raw: tuple[float, ...] = (0.0,) * 6
    """Greatest magnitudes of the deck-frame wrench since arming, N and N·m."""
    peak_filtered: tuple[float, ...] = (0.0,) * 6
    resident_peak_bytes: int = 0
    """Greatest resident memory of the process."""
