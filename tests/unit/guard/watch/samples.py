"""Samples and states with only the fields a test cares about."""

import random

from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.interfaces.ft_sensor import FtHealth, WrenchSample
from cellctl.interfaces.stop_channel import FlangeState

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
HEALTHY = FtHealth()


def sample(
    time_s: float, fz: float = 0.0, *, saturated: bool = False, **forces: float
) -> WrenchSample:
    """Noise of a nanonewton on Fx, so that two samples are never equal."""
    return WrenchSample(
        receive_time_s=time_s,
        time_s=time_s,
        number=round(time_s * 1000),
        fx_n=forces.get("fx", 0.0) + random.random() * 1e-9,
        fy_n=forces.get("fy", 0.0),
        fz_n=fz,
        mx_n_m=forces.get("mx", 0.0),
        my_n_m=forces.get("my", 0.0),
        mz_n_m=forces.get("mz", 0.0),
        saturated=saturated,
    )


def flange(time_s: float, rotation: tuple[float, ...] = IDENTITY) -> FlangeState:
    """A resting, unlatched robot."""
    return FlangeState(time_s, (0.0, 0.0, 0.0), rotation, moving=False, stop_latched=False)


def ready_monitor(*, has_channel: bool = False) -> WrenchMonitor:
    """A monitor with a load of nothing, a fresh sample and a fresh pose at time 0."""
    monitor = WrenchMonitor(IDENTITY, has_channel=has_channel)
    monitor.channel_up = True
    monitor.contact.set_gravity_compensation([(0.0, 0.0, 0.0)] * 6, (0.0,) * 6, (0.0, 0.0, -1.0))
    monitor.flange(flange(0.0))
    monitor.sample(sample(0.0))
    return monitor
