"""The guard without processes: the same limits and detectors, fed once a simulated millisecond."""

import asyncio
import math
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import GuardRefused
from cellctl.force.compensation import Compensation
from cellctl.geometry.pose import Array
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import Curve, GuardSample, GuardTrip, TareResult, TripReason

SAMPLE_S = 1e-3
NAMES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


class WorldGuard:
    """What ``GuardClient`` offers to mating; ``tick`` is its process."""

    def __init__(
        self,
        compensation: Compensation,
        flange_T_sensor: RigidTransform,
        request_stop: Callable[[float], None],
    ) -> None:
        self._compensation, self._flange_T_sensor = compensation, flange_T_sensor
        self._request_stop = request_stop
        self._pose: RigidTransform | None = None
        self._load = np.zeros(6)
        self._deck_A_sensor = np.eye(6)
        self._tare = np.zeros(6)
        self._limits: GuardLimits | None = None
        self._filtered = np.zeros(6)
        self._cusum = 0.0
        self._equal = self._bad = 0
        self._last = GuardSample(0.0, 0.0, 0, np.zeros(6), np.zeros(6), math.inf)
        self._times: list[float] = []
        self._wrenches: list[Array] = []
        self._raws: list[Array] = []
        self.trip: GuardTrip | None = None

    # -- what the process does ------------------------------------------------------------------
    def tick(self, time_s: float, raw: Array | None, base_T_flange: RigidTransform) -> None:
        """One millisecond: a sample, or None when none came."""
        if raw is None:
            self._check_silence(time_s)
            return
        if not np.isfinite(raw).all():
            self._bad += 1
            if self._limits and self._bad >= self._limits.bad_frames:
                self._stop(time_s, TripReason.SENSOR_INVALID, f"{self._bad} damaged frames")
            return
        if base_T_flange is not self._pose:
            self._pose = base_T_flange
            rotation = base_T_flange.rotation * self._flange_T_sensor.rotation
            self._load = self._compensation.load(rotation)
        wrench = self._deck_A_sensor @ (raw - self._load) - self._tare
        number = self._last.number + 1
        self._equal = self._equal + 1 if np.array_equal(raw, self._last.raw) else 1
        self._last = GuardSample(time_s, time_s, number, wrench, raw, 0.0)
        self._times.append(time_s)
        self._wrenches.append(wrench)
        self._raws.append(raw)
        self._watch(time_s, wrench)

    def _watch(self, time_s: float, wrench: Array) -> None:
        limits = self._limits
        if limits is None or self.trip is not None:
            return
        gain = -math.expm1(-SAMPLE_S / limits.filter_s)
        self._filtered += gain * (wrench - self._filtered)
        if self._equal >= limits.frozen_samples:
            self._stop(time_s, TripReason.SENSOR_FROZEN, f"{self._equal} equal samples")
            return
        checks = (
            (TripReason.RAW_LIMIT, wrench, limits.raw),
            (TripReason.FILTERED_LIMIT, self._filtered, limits.filtered),
        )
        for reason, values, bounds in checks:
            over = np.abs(values) > bounds
            if over.any():
                index = int(np.argmax(over))
                detail = f"{NAMES[index]} {values[index]:.1f} beyond {bounds[index]:.1f}"
                self._stop(time_s, reason, detail, index)
                return
        touch = limits.touch
        if touch is not None:
            self._cusum = max(0.0, self._cusum + wrench[2] - touch.drift_n)
            if self._cusum > touch.threshold_n:
                self._stop(time_s, TripReason.TOUCH, f"touch at {wrench[2]:.1f} N", 2)

    def _check_silence(self, time_s: float) -> None:
        limits = self._limits
        if limits and self.trip is None and time_s - self._last.time_s > limits.stale_s:
            self._stop(time_s, TripReason.SENSOR_SILENT, f"{limits.stale_s * 1e3:.0f} ms")

    def _stop(
        self, time_s: float, reason: TripReason, detail: str, component: int | None = None
    ) -> None:
        self.trip = GuardTrip(reason, time_s, detail, component)
        self._request_stop(time_s)

    # -- what the client offers -----------------------------------------------------------------
    def latest(self) -> GuardSample:
        return self._last

    def samples(self, since_s: float) -> Curve:
        first = int(np.searchsorted(np.array(self._times), since_s, side="right"))
        times = np.array(self._times[first:])
        wrench = np.array(self._wrenches[first:]).reshape(-1, 6)
        raw = np.array(self._raws[first:]).reshape(-1, 6)
        return Curve(times, wrench, raw, np.zeros(len(times)), overrun=False)

    async def set_deck_frame(self, sensor_T_deck: RigidTransform) -> None:
        deck_T_sensor = sensor_T_deck.inv()
        rotation, (x, y, z) = deck_T_sensor.rotation.as_matrix(), deck_T_sensor.translation
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        self._deck_A_sensor = np.block([[rotation, np.zeros((3, 3))], [cross @ rotation, rotation]])
        self._tare = np.zeros(6)

    async def tare(self, duration_s: float) -> TareResult:
        begin_s = asyncio.get_running_loop().time()
        await asyncio.sleep(duration_s)
        curve = self.samples(begin_s)
        mean = curve.wrench.mean(axis=0)
        self._tare = self._tare + mean
        return TareResult(mean, curve.wrench.std(axis=0), len(curve.time_s))

    async def arm(self, limits: GuardLimits) -> None:
        if self.trip is not None:
            raise GuardRefused("a trip is latched")
        if asyncio.get_running_loop().time() - self._last.time_s > limits.stale_s + SAMPLE_S:
            raise GuardRefused("no fresh sample")
        self._limits = limits
        self._filtered = self._last.wrench.copy()
        self._cusum = 0.0
        self._bad = 0

    async def disarm(self) -> None:
        self._limits = None

    async def acknowledge(self) -> None:
        self.trip = None
