"""The guard without its process: the real monitor, fed once a simulated millisecond."""

import asyncio
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import Array
from cellctl.guard.health import GuardHealth
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardSample, GuardSamples, GuardTrip, TareResult
from cellctl.guard.settling import Settling
from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.interfaces.ft_sensor import FtHealth, WrenchSample
from cellctl.interfaces.stop_channel import FlangeState

POLL_S = 0.005
SLOTS = 600_000
"""Ten minutes of samples."""
STOP_CONFIRM_S = 0.1
"""The same as in ``GuardSettings``: a stop that is not latched by then withholds the heartbeat."""


class WorldGuard:
    """What ``GuardClient`` offers to mating; ``tick`` is its process."""

    def __init__(
        self,
        compensation: GravityCompensation,
        flange_T_sensor: RigidTransform,
        request_stop: Callable[[float], None],
    ) -> None:
        self.settling = Settling()
        self._flange_R_sensor = _nine(flange_T_sensor)
        self.begin_anew()
        self._compensate(compensation)
        self._request_stop = request_stop
        self._flange: RigidTransform | None = None
        self._invalid = 0
        self._number = 0
        self._stop_s: float | None = None
        self._last: GuardSample | None = None
        self._kept = np.zeros((SLOTS, 13))

    def begin_anew(self) -> None:
        """A new process in its place: nothing is set."""
        self._monitor = WrenchMonitor(self._flange_R_sensor, has_channel=True)
        self._monitor.channel_up = True
        self.gravity_compensated = False
        self.in_part_frame = False
        self.hidden_axial_n: float | None = None

    # -- what the process does ------------------------------------------------------------------
    def tick(
        self, time_s: float, raw: Array | None, flange: RigidTransform, *, saturated: bool = False
    ) -> None:
        """One millisecond: a sample, or None when none came."""
        if flange is not self._flange:
            self._flange = flange
            x, y, z = map(float, flange.translation)
            state = FlangeState(time_s, (x, y, z), _nine(flange), moving=False, stop_latched=False)
            self._monitor.flange(state)
        if raw is not None and not np.isfinite(raw).all():
            self._invalid += 1
        elif raw is not None:
            self._sample(time_s, raw, saturated)
        self._monitor.sensor_health(self._health, time_s)
        self._monitor.tick(time_s)
        if self._monitor.trip is not None and self._stop_s is None:
            self._stop_s = time_s
            self._request_stop(time_s)

    def beats(self, time_s: float, *, latched: bool) -> bool:
        """Whether the heartbeat goes out: not while a stop stays unheard."""
        if latched or self._stop_s is None:
            return True
        return time_s - self._stop_s <= STOP_CONFIRM_S

    @property
    def _health(self) -> FtHealth:
        return FtHealth(samples=self._number, invalid=self._invalid)

    def _sample(self, time_s: float, raw: Array, saturated: bool) -> None:
        self._number += 1
        sample = WrenchSample._make((time_s, time_s, self._number, *raw.tolist(), saturated))
        wrench = np.array(self._monitor.sample(sample))
        self._last = GuardSample(time_s, time_s, self._number, wrench, raw, 0.0)
        self._kept[self._number - 1] = (time_s, *wrench, *raw)

    # -- what the client offers -----------------------------------------------------------------
    @property
    def trip(self) -> GuardTrip | None:
        return self._monitor.trip

    def health(self) -> GuardHealth:
        return GuardHealth(alive=True, stop_channel_up=True, sensor=self._health)

    def latest(self) -> GuardSample:
        assert self._last is not None
        return self._last

    def samples(self, since_s: float) -> GuardSamples:
        kept = self._kept[: self._number]
        part = kept[np.searchsorted(kept[:, 0], since_s, side="right") :]
        return GuardSamples(
            part[:, 0], part[:, 1:7], part[:, 7:], np.zeros(len(part)), overrun=False
        )

    async def set_gravity_compensation(self, compensation: GravityCompensation) -> None:
        self._monitor.require_unarmed()
        self._compensate(compensation)
        self._monitor.signal_jumped()

    def _compensate(self, compensation: GravityCompensation) -> None:
        self._monitor.contact.set_gravity_compensation(
            [(float(x), float(y), float(z)) for x, y, z in compensation.A],
            [float(value) for value in compensation.b],
            compensation.base_down,
        )
        self.gravity_compensated = bool(compensation.A.any())

    async def set_wrench_frame(self, sensor_T_wrench: RigidTransform | None) -> None:
        self._monitor.require_unarmed()
        frame = RigidTransform.identity() if sensor_T_wrench is None else sensor_T_wrench
        self._monitor.contact.set_wrench_frame(_nine(frame), frame.translation.tolist())
        self.in_part_frame = sensor_T_wrench is not None
        self._monitor.signal_jumped()

    async def tare(self, duration_s: float, *, hides_axial_n: float = 0.0) -> TareResult:
        self._monitor.begin_tare(duration_s, asyncio.get_running_loop().time())
        async with asyncio.timeout(duration_s + 1.0):
            while self._monitor.tare_result is None:  # noqa: ASYNC110 - set by the simulation
                await asyncio.sleep(POLL_S)
        found, self.hidden_axial_n = self._monitor.tare_result, hides_axial_n
        return TareResult(np.array(found.mean), np.array(found.sigma), found.samples)

    async def arm(self, limits: GuardLimits) -> None:
        self._monitor.arm(limits, self._health, asyncio.get_running_loop().time())

    async def disarm(self) -> None:
        self._monitor.disarm()

    async def acknowledge(self) -> None:
        self._monitor.acknowledge()
        self._stop_s = None


def _nine(pose: RigidTransform) -> tuple[float, ...]:
    return tuple(pose.rotation.as_matrix().ravel().tolist())
