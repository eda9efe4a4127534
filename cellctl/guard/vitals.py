"""What the guard's status in the shared memory says about it."""

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.force import GuardDied, SensorSilent
from cellctl.errors.link import LinkLost
from cellctl.guard.report import GuardHealth
from cellctl.guard.ring import Status

_HUNG_S = 1.0
"""A guard whose status is older hangs; the robot's dead man has long acted by then."""
_SILENT_S = 1.0
"""Silence that is a fault even while nothing is armed."""


def health(status: Status | None, serial: str, degraded: tuple[str, ...]) -> GuardHealth:
    """How a guard with this newest status is doing; None when there is no guard."""
    if status is None:
        return GuardHealth(alive=False, degraded=degraded)
    time_s = now_s()
    return GuardHealth(
        alive=time_s - status.time_s < _HUNG_S,
        armed=bool(status.armed),
        latched=bool(status.latched),
        stop_channel_up=bool(status.channel_up),
        sensor_open=bool(status.sensor_open),
        degraded=degraded,
        sensor_serial=serial,
        sensor=status.sensor,
        sample_age_s=time_s - status.sample_time_s,
        flange_age_s=time_s - status.flange_time_s,
        late_wakeups=status.late_wakeups,
        peak_raw=status.peak_raw,
        peak_filtered=status.peak_filtered,
        resident_peak_bytes=status.resident_peak_bytes,
    )


def fault(health: GuardHealth) -> CellError | None:
    """What is wrong with a guard whose process runs."""
    if not health.alive:
        return GuardDied(f"its status is more than {_HUNG_S:g} s old")
    if not health.sensor_open:
        return SensorSilent("the guard has given it up")
    if not health.stop_channel_up:
        return LinkLost("the guard's stop channel to the robot is down")
    if health.sample_age_s > _SILENT_S:
        return SensorSilent(f"no sample for {health.sample_age_s:.1f} s")
    return None
