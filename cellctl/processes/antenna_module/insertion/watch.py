"""Watches a live insertion, sample by sample."""

from collections import deque
from dataclasses import dataclass
from enum import Enum

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.insertion.curve import InsertionSample
from cellctl.processes.antenna_module.insertion.limits import (
    InsertionLimits,
    InsertionPhase,
    PhaseLimits,
)

_TREND_S = 0.1
"""Stretch of samples from which it is told whether the axial force rises."""


class TripCause(Enum):
    """Which bound was passed."""

    AXIAL_EARLY = "axial force before the contact springs"
    SIDE = "side force"
    MOMENT = "moment about the insertion axis"
    OVER = "axial force"
    PRESSURE = "centre of pressure"


@dataclass(frozen=True, slots=True)
class InsertionTrip:
    """Why and where to stop."""

    cause: TripCause
    phase: InsertionPhase
    t_s: float
    depth_m: float
    value: float
    """N, N·m or m."""
    limit: float


class InsertionWatch:
    """Holds the last samples; the first bound passed wins, and stays."""

    def __init__(self, limits: InsertionLimits, mean_of: int = 5) -> None:
        """``mean_of``: samples whose mean is compared, against the sensor's noise."""
        self._limits = limits
        self._latest = _RunningMean(mean_of)
        self._slow = _RunningMean(None, limits.pressure_mean_s)
        self._trend: deque[tuple[float, float]] = deque()
        self.trip: InsertionTrip | None = None

    def feed(self, sample: InsertionSample) -> InsertionTrip | None:
        """The next sample; the trip, once there is one."""
        smooth, slow = self._latest.of(sample), self._slow.of(sample)
        # The first bound that was passed is the cause; what is passed after it is often its
        # consequence.
        if self.trip is None:
            self.trip = self._judge(smooth, slow)
        self._trend.append((sample.t_s, smooth.axial_n))
        while self._trend[0][0] < sample.t_s - _TREND_S:
            self._trend.popleft()
        return self.trip

    def _judge(self, sample: InsertionSample, slow: InsertionSample) -> InsertionTrip | None:
        bounds = self._limits.at(sample.depth_m)
        if bounds.phase is InsertionPhase.ENTRY and self._rises(sample.axial_n):
            early_n = self._limits.entry_axial_n
            return _trip(TripCause.AXIAL_EARLY, bounds, sample, sample.axial_n, early_n)
        over = TripCause.OVER if bounds.phase is InsertionPhase.SLIDING else TripCause.AXIAL_EARLY
        pressure = slow.centre_of_pressure_m(self._limits.least_pressure_n)
        lever_m = 0.0 if pressure is None else float(np.linalg.norm(pressure))
        for cause, value, limit in (
            (over, abs(sample.axial_n), bounds.axial_n),
            (TripCause.SIDE, sample.side_n, bounds.side_n),
            (TripCause.MOMENT, abs(float(sample.moment_n_m[2])), bounds.moment_z_n_m),
            (TripCause.PRESSURE, lever_m, bounds.centre_of_pressure_m),
        ):
            # Written so that a value that is not a number trips.
            if not value <= limit:
                return _trip(cause, bounds, sample, value, limit)
        return None

    def _rises(self, axial_n: float) -> bool:
        if axial_n <= self._limits.entry_axial_n:
            return False
        before = [force for _, force in self._trend]
        # Against its own past: a steady pull of a hose lies above no mean of itself.
        return not before or axial_n > float(np.mean(before)) + self._limits.entry_rise_n


def _trip(
    cause: TripCause, bounds: PhaseLimits, sample: InsertionSample, value: float, limit: float
) -> InsertionTrip:
    return InsertionTrip(cause, bounds.phase, sample.t_s, sample.depth_m, value, limit)


class _RunningMean:
    """Mean wrench of the last ``count`` samples, or of those within ``seconds``, at the newest
    depth."""

    def __init__(self, count: int | None, seconds: float = float("inf")) -> None:
        self._count, self._seconds = count, seconds
        self._samples: deque[tuple[float, Array]] = deque()
        self._sum = np.zeros(6)

    def of(self, sample: InsertionSample) -> InsertionSample:
        """The means with the next sample taken in."""
        # Summed up as it goes: a thousand samples a second are too many to add up seventy of them
        # for each.
        wrench = np.concatenate([sample.force_n, sample.moment_n_m])
        self._samples.append((sample.t_s, wrench))
        self._sum += wrench
        while self._is_old(self._samples[0][0], sample.t_s):
            self._sum -= self._samples.popleft()[1]
        mean = self._sum / len(self._samples)
        return InsertionSample(sample.t_s, sample.depth_m, mean[:3], mean[3:])

    def _is_old(self, t_s: float, now_s: float) -> bool:
        too_many = self._count is not None and len(self._samples) > self._count
        return too_many or t_s < now_s - self._seconds
