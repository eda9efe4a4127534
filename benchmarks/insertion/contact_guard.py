"""Sensor and guard of the cell without wires: bandwidth, noise, faults, and limits.

Both take the milliseconds of one tick of the stream together: nobody looks at them in between, and
one array for all of them costs hardly more than one for each.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.geometry.pose import Array
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardSamples, GuardTrip, TareResult, TripReason
from cellctl.guard.watch.detectors import FrozenDetector

STEP_S = 1e-3
TARE_STEPS = 60
"""Samples at standstill before a contact; no call has more."""
_BANDWIDTH_HZ = 200.0
_BLOCK = 4096


class SensorFault:
    """A sensor that tells something else than what acts on it, from a moment on."""

    def __init__(
        self,
        told: Callable[[Array, Array], Array],
        *,
        begins_with: Callable[[Array], bool] | None = None,
    ) -> None:
        """``told``: what it tells for a true sample and for the last one before the fault.

        ``begins_with``: the true sample with which the fault begins; None where a time says it.
        """
        self.begins_s = np.inf
        """Beginning on the clock of the world; set by whoever knows when."""
        self.begins_with = begins_with
        self._told, self._last = told, np.zeros(6)

    def tell(self, sample: Array, now_s: float) -> Array:
        """What the sensor tells for one true sample, shape (6,)."""
        if np.isinf(self.begins_s) and self.begins_with is not None and self.begins_with(sample):
            self.begins_s = now_s
        if now_s < self.begins_s:
            self._last = sample
            return sample
        return self._told(sample, self._last)


@dataclass(frozen=True, slots=True, eq=False)
class SensorNoise:
    """Noise of a sensor in each millisecond, drawn in blocks."""

    force_n: float
    """Standard deviation of each component, as that of the moment."""
    moment_n_m: float
    rng: np.random.Generator

    def block(self) -> Array:
        """Shape (n, 6)."""
        sigma = np.repeat([self.force_n, self.moment_n_m], 3)
        return np.asarray(self.rng.normal(0.0, 1.0, (_BLOCK, 6)) * sigma)


class InsertionGuard:
    """The sensor through its bandwidth and noise, and the limits of the guard on it."""

    def __init__(self, noise: SensorNoise, fault: SensorFault | None) -> None:
        self._noise, self._fault = noise, fault
        self._frozen: FrozenDetector | None = None
        self._trip: GuardTrip | None = None
        self._frames: ContactFrames | None = None
        self._limits: GuardLimits | None = None
        self._block, self._used = noise.block(), 0
        self._bandwidth = _LowPass(1.0 - np.exp(-STEP_S * 2 * np.pi * _BANDWIDTH_HZ))
        self._filter = self._bandwidth
        self._felt, self._filtered = np.zeros(6), np.zeros(6)
        self._times: list[float] = []
        self._wrenches: list[Array] = []

    def give_in(self, frames: ContactFrames) -> TareResult:
        """Give forces about the tip of these frames from now on, as after a tare at standstill."""
        self._frames = frames
        self._times, self._wrenches = [], []
        return TareResult(np.zeros(6), self._block.std(axis=0), 500)

    def publish(self, times_s: Sequence[float], flanges: Array, base_wrenches: Array) -> None:
        """Milliseconds have passed: the flange in them, shape (n, 4, 4), and the wrench on the peg
        about the origin of the base, shape (n, 6)."""
        if self._frames is None:
            return
        felt = self._felt_rows(flanges, base_wrenches, self._frames)
        samples = felt + self._next_noise(len(times_s))
        if self._fault is not None:
            told = zip(samples, times_s, strict=True)
            samples = np.array([self._fault.tell(sample, at_s) for sample, at_s in told])
        self._times += times_s
        self._wrenches += list(samples)
        if self._limits is not None:
            self._watch(times_s, samples, self._limits)

    @property
    def trip(self) -> GuardTrip | None:
        """The latched trip."""
        return self._trip

    def samples(self, since_s: float) -> GuardSamples:
        """See ``GuardPort``."""
        first = bisect_right(self._times, since_s)
        wrench = np.array(self._wrenches[first:]).reshape(-1, 6)
        times = np.array(self._times[first:])
        return GuardSamples(times, wrench, wrench.copy(), np.zeros(len(wrench)), overrun=False)

    async def arm(self, limits: GuardLimits) -> None:
        """Watch these limits from now on."""
        self._limits, self._frozen = limits, FrozenDetector(limits.frozen_samples)
        self._filter = _LowPass(STEP_S / (limits.filter_s + STEP_S))

    async def disarm(self) -> None:
        """Watch nothing."""
        self._limits = None

    def _felt_rows(self, flanges: Array, base_wrenches: Array, frames: ContactFrames) -> Array:
        """What the sensor feels, about the tip and in its axes, behind its bandwidth."""
        about_tip = np.zeros((len(flanges), 6))
        if base_wrenches.any():
            tips = flanges @ frames.flange_T_tip.as_matrix()
            force, (x, y, z), (fx, fy, fz) = (
                base_wrenches[:, :3], tips[:, :3, 3].T, base_wrenches[:, :3].T,
            )  # fmt: skip
            # What np.cross computes, in a fraction of its time.
            moved = np.column_stack([y * fz - z * fy, z * fx - x * fz, x * fy - y * fx])
            both = np.stack([force, base_wrenches[:, 3:] - moved], axis=1)
            # Rows times a matrix: the inverse rotation.
            about_tip = (both @ tips[:, :3, :3]).reshape(-1, 6)
        felt = self._bandwidth.of(about_tip, self._felt)
        self._felt = felt[-1]
        return felt

    def _next_noise(self, count: int) -> Array:
        left = self._block[self._used : self._used + count]
        self._used += count
        if len(left) == count:
            return left
        self._block, self._used = self._noise.block(), count - len(left)
        return np.concatenate([left, self._block[: self._used]])

    def _watch(self, times_s: Sequence[float], samples: Array, limits: GuardLimits) -> None:
        filtered = self._filter.of(samples, self._filtered)
        self._filtered = filtered[-1]
        trips: list[tuple[int, TripReason, str]] = []
        if self._frozen is not None:
            update = self._frozen.update
            frozen = [update((a, b, c, d, e, f)) for a, b, c, d, e, f in samples.tolist()]
            if any(frozen):
                trips.append((frozen.index(True), TripReason.SENSOR_FROZEN, ""))
        for reason, seen, most in (
            (TripReason.FILTERED_LIMIT, filtered, limits.filtered),
            (TripReason.RAW_LIMIT, samples, limits.raw),
        ):
            size = np.abs(seen)
            beyond = (size > most).any(axis=1)
            if beyond.any():
                first = int(beyond.argmax())
                trips.append((first, reason, f"{size[first].max():.1f}"))
        if trips and self._trip is None:
            first, reason, words = min(trips, key=lambda one: one[0])
            self._trip = GuardTrip(reason, times_s[first], words)


class _LowPass:
    """First order, by one product for all samples of a call."""

    def __init__(self, share: float) -> None:
        """``share`` of the difference to a sample that the state follows in its millisecond."""
        steps = np.arange(TARE_STEPS)
        self._kept = (1.0 - share) ** (steps + 1)[:, None]
        powers = np.maximum(steps[:, None] - steps, 0)
        self._weights = np.tril(share * (1.0 - share) ** powers)

    def of(self, samples: Array, state: Array) -> Array:
        """The state after each sample, shape (n, 6), beginning at one of shape (6,)."""
        count = len(samples)
        return np.asarray(self._kept[:count] * state + self._weights[:count, :count] @ samples)
