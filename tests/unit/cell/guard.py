"""The guard as the daemon sees it, without a process."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.guard.health import GuardHealth
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardSample, GuardSamples, GuardTrip, TareResult
from cellctl.guard.settling import Settling

SENSOR = "M4347K-1"
AT_ONCE = Settling(window_s=0.0, poll_s=0.0, reading_s=0.0)


@dataclass
class TinyGuard:
    """Remembers what it was asked; a test sets the trip and what is wrong."""

    serial: str = SENSOR
    settling: Settling = AT_ONCE
    """What hangs on the robot is still at once."""
    trip: GuardTrip | None = None
    gravity_compensated: bool = True
    in_part_frame: bool = True
    hidden_axial_n: float | None = 0.0
    sensor_T_wrench: RigidTransform | None = None
    """The part's frame that was given last; ``raw`` is not turned into it."""
    armed: bool = False
    limits: list[GuardLimits] = field(default_factory=list)
    """Limits of every arming."""
    asked: list[str] = field(default_factory=list)
    faults: dict[str, CellError] = field(default_factory=dict)
    degraded: tuple[str, ...] = ()
    """Real-time measures that were refused."""
    silent_s: float = 0.0
    """How long ago the newest sample came."""
    raw: np.ndarray = field(
        default_factory=lambda: np.random.default_rng(1).normal(0.0, 0.2, (200, 6))
    )

    async def start(self) -> None:
        self._do("start")

    async def stop(self) -> None:
        self._do("stop")

    async def set_gravity_compensation(self, compensation: object) -> None:
        self._do("set_gravity_compensation")
        self.gravity_compensated, self.hidden_axial_n = True, None

    async def set_wrench_frame(self, sensor_T_wrench: object) -> None:
        self._do("set_wrench_frame")
        self.in_part_frame, self.hidden_axial_n = sensor_T_wrench is not None, None
        if isinstance(sensor_T_wrench, RigidTransform):
            self.sensor_T_wrench = sensor_T_wrench

    async def tare(self, duration_s: float, *, hides_axial_n: float = 0.0) -> TareResult:
        self._do("tare")
        self.hidden_axial_n = hides_axial_n
        return TareResult(np.zeros(6), np.ones(6), 100)

    async def arm(self, limits: GuardLimits) -> None:
        self._do("arm")
        self.armed = True
        self.limits.append(limits)

    async def disarm(self) -> None:
        self._do("disarm")
        self.armed = False

    async def stop_robot(self) -> None:
        self._do("stop_robot")

    async def acknowledge(self) -> None:
        self._do("acknowledge")
        self.armed, self.trip = False, None

    def samples(self, since_s: float) -> GuardSamples:
        count = len(self.raw)
        return GuardSamples(
            np.linspace(since_s, now_s(), count), self.raw, self.raw, np.zeros(count), overrun=False
        )

    def newest(self) -> GuardSample | None:
        if not len(self.raw):
            return None
        time_s = now_s() - self.silent_s
        return GuardSample(time_s, time_s, 1, self.raw[-1], self.raw[-1], 0.01)

    def latest(self) -> GuardSample:
        sample = self.newest()
        assert sample is not None
        return sample

    def check(self) -> None:
        if "check" in self.faults:
            raise self.faults["check"]

    def health(self) -> GuardHealth:
        return GuardHealth(alive=True, sensor_serial=self.serial, degraded=self.degraded)

    def _do(self, what: str) -> None:
        self.asked.append(what)
        if what in self.faults:
            raise self.faults[what]
