"""Makes the guard's limits from filtered ones: adds the margins for noise and sample rate."""

from dataclasses import dataclass
from typing import Self

from cellctl.config.devices import ForceSensorConfig
from cellctl.config.driver_settings import sensor_rate_hz
from cellctl.guard.limits import (
    DEFAULT_FILTER_S,
    DEFAULT_RATE_WINDOW_S,
    CusumTouch,
    GuardLimits,
    Six,
)

RAW_MARGIN_N = 12.0
RAW_MARGIN_N_M = 6.0
"""How far a single sample may exceed the filtered limit because of its noise.

No data sheet states that noise. Assumed is 0.05 % of a full scale of 5 kN and 1 kN·m, that is
2.5 N and 0.5 N·m: 12 N are nearly five standard deviations, so that even of a force at its filtered
limit only one sample in a million passes them by chance."""
RATE_RATIO = 0.1
"""How much the rate of the sensor may differ from its nominal rate: far more than any clock is off,
and far less than a wrong set-up makes (half or twice the rate)."""


@dataclass(frozen=True, slots=True)
class Sensing:
    """How often the guard hears from sensor and robot, and how long it waits for them."""

    rate_hz: float
    stale_s: float
    flange_age_s: float

    @classmethod
    def of(cls, sensor: ForceSensorConfig) -> Self:
        """The rate and the waiting times that the cell file gives for a sensor."""
        return cls(sensor_rate_hz(sensor), sensor.stale_ms / 1e3, sensor.flange_age_ms / 1e3)

    @property
    def rate_band_hz(self) -> tuple[float, float]:
        """Rates that count as right, averaged over a window of the guard's rate detector."""
        # A gap of almost ``stale_s`` is allowed, and a window of the rate detector that contains it
        # counts that many samples less. Without this share it would trip for the rate.
        slack = RATE_RATIO + self.stale_s / DEFAULT_RATE_WINDOW_S
        return max(0.0, 1.0 - slack) * self.rate_hz, (1.0 + slack) * self.rate_hz


def guard_limits(
    filtered: Six,
    sensing: Sensing,
    *,
    braking: Six | None = None,
    touch: CusumTouch | None = None,
    filter_s: float = DEFAULT_FILTER_S,
) -> GuardLimits:
    """What the guard watches when the filtered wrench may be as great as ``filtered``.

    ``braking`` is what it may be while the robot brakes after a stop that the daemon has asked for.
    """
    fx, fy, fz, mx, my, mz = filtered
    return GuardLimits(
        raw=(
            fx + RAW_MARGIN_N,
            fy + RAW_MARGIN_N,
            fz + RAW_MARGIN_N,
            mx + RAW_MARGIN_N_M,
            my + RAW_MARGIN_N_M,
            mz + RAW_MARGIN_N_M,
        ),
        filtered=filtered,
        braking=braking,
        touch=touch,
        filter_s=filter_s,
        stale_s=sensing.stale_s,
        flange_age_s=sensing.flange_age_s,
        rate_hz=sensing.rate_band_hz,
    )
