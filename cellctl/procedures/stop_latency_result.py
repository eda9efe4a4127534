"""The stop latency from single stops: the latency, its verdict, and its form in the record."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.checks import Checks, LimitCheck, evidence_to_record
from cellctl.force.contact.commissioning import LatencyEstimate, estimate_stop_latency
from cellctl.geometry.pose import MM, Array

SIGMA_MS = 15.0
"""Largest standard deviation of the latency."""
UPPER_BOUND = "upper bound"
"""Name of the check that holds the result against what every recipe is safe with."""
METHOD = "overrun against speed"
"""Name of the method in the record, which tells it from those of other procedures."""
RESIDUAL_MM = 0.15
"""The robot reports every 20 ms: at 8 mm/s that is 0.16 mm between two reports."""


@dataclass(frozen=True, slots=True, eq=False)
class TimedStop:
    """One stop on the way, as the robot has reported it; places in the base, m, shape (3,)."""

    speed_m_s: float
    start_m: Array
    seen_m: Array
    """Place of the newest report when the stop was requested."""
    report_age_s: float
    """Age of that report then."""
    end_m: Array
    """At standstill."""

    def overrun_m(self, direction: Array) -> float:
        """Way from the request to standstill along a unit vector."""
        seen_m = float((self.seen_m - self.start_m) @ direction)
        # The newest report is up to one cycle of the robot old; at constant speed the way since
        # then is known.
        return self.way_m(direction) - (seen_m + self.speed_m_s * self.report_age_s)

    def way_m(self, direction: Array) -> float:
        """The whole way, from the start to standstill."""
        return float((self.end_m - self.start_m) @ direction)

    def to_input(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "speed_m_s": self.speed_m_s,
            "start_m": self.start_m.tolist(),
            "seen_m": self.seen_m.tolist(),
            "report_age_s": self.report_age_s,
            "end_m": self.end_m.tolist(),
        }

    @classmethod
    def from_input(cls, written: Mapping[str, Any]) -> "TimedStop":
        """The inverse of ``to_input``."""
        start_m, seen_m, end_m = (
            np.array(written[name], dtype=float) for name in ("start_m", "seen_m", "end_m")
        )
        return cls(written["speed_m_s"], start_m, seen_m, written["report_age_s"], end_m)


@dataclass(frozen=True, slots=True, eq=False)
class StopLatency:
    """The measurement with its data."""

    estimate: LatencyEstimate
    speeds_m_s: Array
    overruns_m: Array

    @classmethod
    def of(cls, stops: Sequence[TimedStop], direction: Array) -> "StopLatency":
        """From stops along a unit vector; raises ``CommissioningFailed``."""
        speeds_m_s = np.array([stop.speed_m_s for stop in stops])
        overruns_m = np.array([stop.overrun_m(direction) for stop in stops])
        return cls(estimate_stop_latency(speeds_m_s, overruns_m), speeds_m_s, overruns_m)

    def checks(self, bound_ms: float) -> Checks:
        """The verdict; ``bound_ms``: what every recipe is safe with while this does not hold."""
        estimate = self.estimate
        return (
            LimitCheck(UPPER_BOUND, estimate.upper_s * 1e3, bound_ms, "ms"),
            LimitCheck("sigma", estimate.sigma_s * 1e3, SIGMA_MS, "ms"),
            LimitCheck("residual", estimate.residual_m / MM, RESIDUAL_MM, "mm"),
        )

    def to_record(self, checks: Checks) -> dict[str, Any]:
        """Plain data for the store."""
        estimate = self.estimate
        return {
            **evidence_to_record(METHOD, checks),
            "latency_ms": estimate.latency_s * 1e3,
            "sigma_ms": estimate.sigma_s * 1e3,
            "upper_ms": estimate.upper_s * 1e3,
            "offset_mm": estimate.offset_m / MM,
            "residual_mm": estimate.residual_m / MM,
            "speeds_mm_s": (self.speeds_m_s / MM).tolist(),
            "overruns_mm": (self.overruns_m / MM).tolist(),
        }
