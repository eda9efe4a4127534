"""What is imperfect about an arm beside its links and its repeatability."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from fakes.scenario_file.scenario import Scenario
from fakes.world.flaws.drift import ThermalDrift
from fakes.world.flaws.transmission import Transmission
from fakes.world.frames import MM, stream

_ARCSEC = np.deg2rad(1 / 3600)
_BASE_HEIGHT_M = 1.0
"""Warmth on one side of a base tilts it as if its top moved at this height."""


@dataclass(slots=True)
class Timing:
    """Latencies that differ from one motion to the next."""

    rng: np.random.Generator
    start_s: float
    """A motion begins later by up to this much."""
    stop_ratio: float
    """The latency of a stop differs by up to this share; the brakes are weaker by up to it."""
    stop_latency_factor: float = 1.0
    braking_factor: float = 1.0

    def begin_motion(self) -> float:
        """Draw anew; returns by how much the motion starts later, s."""
        later, latency, braking = self.rng.uniform(-1, 1, 3).tolist()
        self.stop_latency_factor = max(0.0, 1.0 + latency * self.stop_ratio)
        self.braking_factor = 1.0 / (1.0 + 0.5 * (braking + 1.0) * self.stop_ratio)
        return float(0.5 * (later + 1.0) * self.start_s)


@dataclass(frozen=True, slots=True)
class ArmFlaws:
    """The flaws of one arm; None for each that it does not have."""

    transmission: Transmission | None = None
    base_drift: ThermalDrift | None = None
    timing: Timing | None = None

    @classmethod
    def of(cls, scenario: Scenario, robot: str, seed: int) -> Self:
        """What the scenario says of one of its arms.

        Its transmissions are the same on every day of its life and belong to the hardware seed;
        what differs from day to day and from motion to motion is drawn by ``seed``.

        An arm that carries a camera returns to the pose at which that was calibrated, where the
        transmission errors are the same again: they matter on arms that carry a force sensor.
        """
        carrying = any(one.mounted_on == robot for one in scenario.force_sensors.values())
        ripple_rad = scenario.size_of("reducer_ripple") * _ARCSEC
        sag_rad = scenario.size_of("gravity_sag") * _ARCSEC
        transmission = None
        if carrying and (ripple_rad or sag_rad):
            transmission = Transmission(
                stream(scenario.hardware_seed, "reducer ripple", robot),
                scenario.robots[robot].chain_mm,
                ripple_rad=ripple_rad,
                sag_rad=sag_rad,
            )
        base_m = scenario.size_of("base_drift") * MM
        base = None
        if base_m:
            base = ThermalDrift(stream(seed, "base drift", robot), base_m, _BASE_HEIGHT_M)
        start_s = scenario.size_of("latency_jitter") / 1000
        stop_ratio = scenario.size_of("stop_jitter")
        timing = None
        if start_s or stop_ratio:
            timing = Timing(stream(seed, "latency jitter", robot), start_s, stop_ratio)
        return cls(transmission, base, timing)
