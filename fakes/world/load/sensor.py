"""The six-axis sensor: what it reads when a load is on it."""

import numpy as np

from fakes.scenario_file.sections import ForceSensor
from fakes.world.frames import Array, stream
from fakes.world.truth import ForceSensorTruth

_BLOCK = 4096
_RATE_HZ = 1000


class ForceReading:
    """Raw readings by load and time; the noise of a millisecond is always the same."""

    def __init__(
        self,
        settings: ForceSensor,
        truth: ForceSensorTruth,
        seed: int,
        keys: tuple[str, ...] = (),
    ) -> None:
        """``keys`` tell the noise of this sensor from that of others in the cell."""
        self._truth, self._seed, self._keys = truth, seed, keys
        self._range = np.repeat([settings.range_n, settings.range_nm], 3)
        self._sigma = np.repeat([settings.noise_n, settings.noise_nm], 3)
        rng = stream(seed, "force vibration", *keys)
        share = settings.noise_nm / settings.noise_n if settings.noise_n > 0 else 0.0
        # ``vibration_n`` is a root mean square, and the peak of a sine is higher by the root of 2.
        self._hum = settings.vibration_n * np.array([1, 1, 1, share, share, share]) * np.sqrt(2)
        self._hum_rate = 2 * np.pi * settings.vibration_hz
        self._hum_phase = rng.uniform(0, 2 * np.pi, 6)
        self._blocks: dict[int, Array] = {}

    def read(self, load: Array, time_s: float) -> Array:
        """Fx, Fy, Fz, Mx, My, Mz as the box gets them, from the true load in sensor axes."""
        truth = self._truth
        reading = truth.matrix @ load + truth.offset + truth.drift_per_s * time_s
        reading += self._hum * np.sin(self._hum_rate * time_s + self._hum_phase)
        reading += self._noise(time_s)
        return np.clip(reading, -self._range, self._range)

    def _noise(self, time_s: float) -> Array:
        # Drawn in blocks with a stream for each, so that the noise of a millisecond does not depend
        # on how often and when somebody has asked before.
        block, place = divmod(max(0, int(time_s * _RATE_HZ)), _BLOCK)
        if block not in self._blocks:
            rng = stream(self._seed, "force noise", *self._keys, block)
            self._blocks = {block: rng.normal(0, 1, (_BLOCK, 6)) * self._sigma}
        return np.asarray(self._blocks[block][place])
