"""What the guard reports: samples, the result of a tare, trips.

The guard process imports this module for its trips, so it imports no arrays; they are named in
annotations only.
"""

from __future__ import annotations

from dataclasses import dataclass
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

if TYPE_CHECKING:
    from cellctl.geometry.pose import Array


class TripReason(Enum):
    """Why the guard stopped the robot."""

    TOUCH = "touch"
    """The contact that a guarded move was made to find: the one trip that may be a success."""
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
    """Found by the daemon; the robot is stopped by its own dead man."""


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
    """0 … 5 for Fx … Mz; None when the reason does not concern one component."""
    value: float = 0.0
    """What was compared: N, N·m, seconds, hertz or a count, depending on the reason."""

    @property
    def touch(self) -> bool:
        """True when the touch detector found the contact."""
        return self.reason is TripReason.TOUCH

    @property
    def force(self) -> bool:
        """True for a force or moment beyond its limit."""
        return self.reason in (TripReason.RAW_LIMIT, TripReason.FILTERED_LIMIT)

    def fault(self) -> CellError:
        """The numbered fault of this trip, for a caller to whom it is one."""
        return _FAULTS[self.reason](self.detail)

    def __str__(self) -> str:
        return f"{self.reason.value}: {self.detail}"


@dataclass(frozen=True, slots=True, eq=False)
class GuardSample:
    """One sample as the guard published it."""

    time_s: float
    """De-jittered sample time, monotonic."""
    receive_time_s: float
    number: int
    wrench: Array
    """Shape (6,): gravity compensated and tared, about the origin and in the axes of the wrench
    frame."""
    raw: Array
    """Shape (6,): sensor frame, as received."""
    flange_age_s: float
    """Age of the flange pose that the gravity compensation used; infinite when there is none."""


@dataclass(frozen=True, slots=True, eq=False)
class GuardSamples:
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


@dataclass(frozen=True, slots=True, eq=False)
class TareResult:
    """What was left of the wrench at rest, in the wrench frame; it counts as zero from now on."""

    mean: Array
    """Shape (6,)."""
    sigma: Array
    """Shape (6,): standard deviation of the samples."""
    samples: int
