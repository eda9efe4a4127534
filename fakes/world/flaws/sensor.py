"""What of a six-axis sensor's reading no linear calibration describes."""

import math
from typing import Self

import numpy as np

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import ForceSensor
from fakes.world.frames import Array, stream

STEP_S = 1e-3
_STICKING = np.array([[0.02], [0.1], [0.5]])
"""Ratios of the range at which the parts of the hysteresis give way."""
_RENEWED_EACH = 8
"""Milliseconds from one computation of non-linearity and hysteresis to the next, for speed."""
_CUBIC = 1.5 * math.sqrt(3.0)
"""Factor by which x - x³, which is largest at 1 / sqrt(3), becomes 1 there."""


class SensorFlaws:
    """Non-linearity, hysteresis and bandwidth; one value of the load for each millisecond.

    The hysteresis is that of springs in parallel, each behind a sticking friction of its own
    (Prandtl and Ishlinskii): after a reversal the sensor seems stiffer until they give way again.
    """

    def __init__(
        self,
        settings: ForceSensor,
        rng: np.random.Generator,
        *,
        nonlinearity: float,
        hysteresis: float,
        lag_s: float,
    ) -> None:
        """``nonlinearity`` and ``hysteresis`` are largest deviations as ratios of the range, the
        hysteresis from branch to branch; ``lag_s`` is the time constant of a first-order filter."""
        self._range = np.repeat([settings.range_n, settings.range_nm], 3)
        signs = np.where(rng.random(6) < 0.5, -1.0, 1.0)
        self._bend = nonlinearity * _CUBIC * signs * self._range
        self._limit = _STICKING * self._range
        # Beyond the last of the frictions each branch is off by the sum of all limits, the two in
        # opposite directions; so half of it gives the wanted distance from branch to branch.
        self._share = np.full(3, 0.5 * hysteresis / float(_STICKING.sum()))
        self._follow = 1.0 - math.exp(-STEP_S / lag_s) if lag_s > 0 else 1.0
        self._load: Array | None = None
        self._stuck = np.zeros((3, 6))
        self._bent = self._bent_at = self._shown = np.zeros(6)
        self._age = 0
        self._settled = False

    @classmethod
    def of(cls, scenario: Scenario, sensor: str) -> Self | None:
        """What the scenario says; the signs belong to the device. None for an ideal sensor."""
        sizes = {
            "nonlinearity": scenario.size_of("sensor_nonlinearity"),
            "hysteresis": scenario.size_of("sensor_hysteresis"),
            "lag_s": scenario.size_of("sensor_lag") / 1000,
        }
        if not any(sizes.values()):
            return None
        rng = stream(scenario.hardware_seed, "sensor nonlinearity", sensor)
        return cls(scenario.force_sensors[sensor], rng, **sizes)

    def pass_on(self, load: Array) -> Array:
        """What the sensor shows of a load, without its matrix and its noise; shape (6,)."""
        if load is self._load:
            if self._settled:
                return self._shown
            self._settled = bool(np.abs(load + self._bent - self._shown).max() < 1e-6)
        else:
            self._settled = False
            self._age -= 1
            if self._age <= 0:
                self._bend_by(load)
        # A new array each time, because the history keeps the former ones.
        self._shown = self._shown + self._follow * (load + self._bent - self._shown)
        self._load = load
        return self._shown

    def _bend_by(self, load: Array) -> None:
        """Take over a load into what changes slowly: a fraction of a per cent of its change."""
        if self._load is None:
            self._shown = load
        self._age = _RENEWED_EACH
        stuck = self._stuck
        stuck += load - self._bent_at
        np.minimum(stuck, self._limit, out=stuck)
        np.maximum(stuck, -self._limit, out=stuck)
        ratio = load / self._range
        self._bent = self._bend * (ratio - ratio * ratio * ratio) + self._share @ stuck
        self._bent_at = load
