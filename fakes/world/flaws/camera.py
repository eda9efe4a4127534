"""What is imperfect about a camera beside its lens: its mount, its light, the floor under it."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from fakes.scenario_file.scenario import Scenario
from fakes.world.flaws.drift import ThermalDrift
from fakes.world.frames import MM, Array, stream
from fakes.world.scene import Exposure

_MOUNT_LEVER_M = 0.5
"""Warmth on one side of a mount turns the camera as if the part, at this distance, moved."""
_SWAY_RATE = 2 * np.pi * 12.0
"""Rate (rad/s) at which an arm sways on its joints: 12 Hz, as the hum of the force sensor, which
comes from the same swaying (``fakes.imperfections``, assumed)."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraFlaws:
    """Drift of the mount, sway of what carries it, brightness that differs."""

    camera: str
    seed: int
    duration_s: float
    """How long an exposure takes."""
    sway_rad: float
    """Root mean square of the angle by which the line of sight sways about each axis."""
    sway_phase: Array
    gain_ratio: float
    """Largest relative difference of brightness."""
    drift: ThermalDrift | None

    @classmethod
    def of(cls, scenario: Scenario, camera: str, seed: int) -> Self:
        """What the scenario says of one of its cameras or stereo heads."""
        optics = scenario.optics[scenario.all_cameras()[camera].optics]
        drift_m = scenario.size_of("head_drift") * MM
        drift_rng = stream(seed, "head drift", camera)
        return cls(
            camera=camera,
            seed=seed,
            duration_s=optics.exposure_us * 1e-6,
            sway_rad=scenario.size_of("vibration") * 1e-6,
            sway_phase=stream(seed, "vibration", camera).uniform(0, 2 * np.pi, 2),
            gain_ratio=scenario.size_of("exposure_drift"),
            drift=ThermalDrift(drift_rng, drift_m, _MOUNT_LEVER_M) if drift_m else None,
        )

    def exposure(self, number: int, time_s: float) -> Exposure:
        """What distinguishes the ``number``-th exposure of the cell from one in a still cell."""
        angle = _SWAY_RATE * time_s + self.sway_phase
        peak = self.sway_rad * np.sqrt(2)
        sway_x, sway_y = (peak * np.sin(angle)).tolist()
        # Evenly spread over the way during the exposure, which is short against a period: the
        # standard deviation of such a spread is its length divided by the root of 12.
        way = peak * np.abs(np.cos(angle)) * _SWAY_RATE * self.duration_s
        smear_x, smear_y = (way / np.sqrt(12)).tolist()
        gain = 1.0
        if self.gain_ratio:
            rng = stream(self.seed, "exposure drift", self.camera, number)
            gain += float(rng.uniform(-self.gain_ratio, self.gain_ratio))
        return Exposure((sway_x, sway_y), (smear_x, smear_y), gain)
