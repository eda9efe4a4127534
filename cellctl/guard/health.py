"""How a guard is doing, judged by the daemon from the status in the shared memory."""

from dataclasses import dataclass, field
from typing import Self

from cellctl.errors.base import CellError
from cellctl.errors.force import GuardDied, SensorSilent
from cellctl.errors.link import LinkLost
from cellctl.guard.report import GuardSample
from cellctl.guard.ring import GuardStatus
from cellctl.interfaces.ft_sensor import FtHealth

_HUNG_S = 1.0
"""A guard whose status is older than this hangs: it publishes one at every beat, fifty times a
second. The robot's dead man has stopped the robot long before."""
SILENT_S = 1.0
"""A sensor that is silent for this long is a fault even while the guard is not armed. An armed
guard trips after milliseconds; this only reports, and leaves the driver time to reconnect."""


def is_present(sample: GuardSample, now_s: float) -> bool:
    """Whether a sample still says what the sensor feels.

    The memory that a guard has left keeps its last sample for ever. Shown as a force, it would tell
    whoever goes to an arm that is pressing that it is free.
    """
    return now_s - sample.receive_time_s <= SILENT_S


@dataclass(frozen=True, slots=True)
class GuardHealth:
    """How the guard is doing."""

    alive: bool
    armed: bool = False
    latched: bool = False
    """True while the guard holds a trip."""
    stop_channel_up: bool = False
    """Also True when the guard runs without a stop channel."""
    sensor_open: bool = False
    """False after a fault of the sensor that only a new guard ends, such as another set-up."""
    degraded: tuple[str, ...] = ()
    """Real-time measures that this PC did not permit, in words."""
    sensor_serial: str = ""
    sensor: FtHealth = field(default_factory=FtHealth)
    """The driver's counters."""
    sample_age_s: float = float("inf")
    flange_age_s: float = float("inf")
    late_wakeups: int = 0
    """Times the guard woke more than a millisecond late: the machine stood still."""
    peak_raw: tuple[float, ...] = (0.0,) * 6
    """Greatest magnitudes of the wrench since its zero was set last, N and N·m."""
    peak_filtered: tuple[float, ...] = (0.0,) * 6
    resident_peak_bytes: int = 0
    """Greatest resident memory of the process."""

    @classmethod
    def from_status(
        cls, status: GuardStatus | None, now_s: float, serial: str, degraded: tuple[str, ...]
    ) -> Self:
        """The health of a guard with this newest status; of a dead one without a status."""
        if status is None:
            return cls(alive=False, degraded=degraded)
        return cls(
            alive=now_s - status.time_s < _HUNG_S,
            armed=bool(status.armed),
            latched=bool(status.latched),
            stop_channel_up=bool(status.channel_up),
            sensor_open=bool(status.sensor_open),
            degraded=degraded,
            sensor_serial=serial,
            sensor=status.sensor,
            sample_age_s=now_s - status.sample_time_s,
            flange_age_s=now_s - status.flange_time_s,
            late_wakeups=status.late_wakeups,
            peak_raw=status.peak_raw,
            peak_filtered=status.peak_filtered,
            resident_peak_bytes=status.resident_peak_bytes,
        )

    def fault(self) -> CellError | None:
        """What is wrong with a guard whose process runs; None when nothing is.

        In the order of cause and effect: a guard that hangs also has an old sample.
        """
        if not self.alive:
            return GuardDied(f"its status is more than {_HUNG_S:g} s old")
        # A sensor that was given up comes before the channel: it needs Reset, whereas the channel
        # is reconnected by the guard itself.
        if not self.sensor_open:
            return SensorSilent("the guard has given it up")
        if not self.stop_channel_up:
            return LinkLost("the guard's stop channel to the robot is down")
        if self.sample_age_s > SILENT_S:
            return SensorSilent(f"no sample for {self.sample_age_s:.1f} s")
        return None
