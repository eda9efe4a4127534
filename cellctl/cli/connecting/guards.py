"""What a guard owns is asked without a guard: the force sensor, and its stop channel to the robot.

Both drivers block, as the guard wants it, so each is asked in a thread of its own. No stop is sent
and no limit is armed.
"""

import select
import threading
from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from cellctl import plugins
from cellctl.cli.connecting.answer import Answer, spread_ms
from cellctl.cli.connecting.blocking import in_thread
from cellctl.clock import now_s
from cellctl.config.devices import DeviceConfig, ForceSensorConfig
from cellctl.config.driver_settings import sensor_rate_hz
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.interfaces import FtSensor, StopChannel
from cellctl.interfaces.ft_sensor import FtHealth
from cellctl.interfaces.stop_channel import FlangeState

LISTEN_S = 1.0
_BEAT_S = 0.1
_LOOK_S = 0.02
_RATE_TOLERANCE = 0.05


async def ask_sensor(name: str, config: ForceSensorConfig) -> Answer:
    """A second of samples; raises what the driver raises."""
    return await in_thread(partial(_sensor, name, config))


async def ask_stop_channel(
    name: str, config: ForceSensorConfig, robots_asked: threading.Event
) -> Answer:
    """A second of reports with heartbeats, which go on until the robots have been asked too: a
    controller may latch when it loses the channel. Raises what the driver raises."""
    return await in_thread(partial(_stop_channel, name, config, robots_asked))


def _sensor(name: str, config: ForceSensorConfig, ended: threading.Event) -> Answer:
    sensor: FtSensor = _driver(plugins.FT_SENSOR, config)
    times_s: list[float] = []
    forces_n: list[tuple[float, ...]] = []
    began_s = now_s()
    sensor.open()
    try:
        connect_s = now_s() - began_s
        end_s = now_s() + LISTEN_S
        while now_s() < end_s and not ended.is_set():
            samples = sensor.read(_LOOK_S)
            times_s += [sample.receive_time_s for sample in samples]
            forces_n += [(sample.fx_n, sample.fy_n, sample.fz_n) for sample in samples]
        serial_number, health = sensor.serial_number(), sensor.health()
    finally:
        sensor.close()
    gaps_s = _gaps_s(times_s)
    rate, off_rate = rate_of(health, len(times_s), sensor_rate_hz(config))
    facts = {
        "connected after": f"{connect_s:.2f} s",
        "samples": f"{len(times_s)} in {LISTEN_S:g} s, {rate}",
        "apart": spread_ms(gaps_s),
        **felt(forces_n, config),
    }
    notes = (*off_rate, *_late(gaps_s, config), *_bad(health))
    return Answer(
        f"force_sensors.{name}", config.driver, facts, serial_number=serial_number, notes=notes
    )


def felt(forces_n: Sequence[tuple[float, ...]], config: ForceSensorConfig) -> dict[str, str]:
    """The mean force in the axes of the flange, by the place of the sensor in the cell file: a push
    by hand shows whether that place, and the signs, are right."""
    if not forces_n:
        return {}
    flange_R_sensor = pose_from_xyzabc(config.flange_T_sensor).rotation
    x_n, y_n, z_n = flange_R_sensor.apply(np.mean(forces_n, axis=0))
    felt = f"x {x_n:.1f}  y {y_n:.1f}  z {z_n:.1f} N in axes of the flange"
    return {"force": f"{felt}, weight and offset included"}


def rate_of(health: FtHealth, count: int, set_hz: float) -> tuple[str, tuple[str, ...]]:
    """The rate in words, and what is to be looked at of it beside that of the cell file, in Hz.

    A driver has measured none of a stream that was too short for it or has paused; the ``count`` of
    samples tells it roughly then.
    """
    measured = health.rate_hz > 0.0
    rate_hz = health.rate_hz if measured else count / LISTEN_S
    words = f"{rate_hz:.1f} Hz by its own count"
    if not measured:
        words = "too few or too uneven for a count of its own"
    if abs(rate_hz - set_hz) <= _RATE_TOLERANCE * set_hz:
        return words, ()
    return words, (f"{rate_hz:.1f} Hz measured, the cell file says {set_hz:g} Hz",)


def _late(gaps_s: list[float], config: ForceSensorConfig) -> tuple[str, ...]:
    """Silences for which an armed guard would trip."""
    most_ms = 1e3 * max(gaps_s, default=0.0)
    if most_ms <= config.stale_ms:
        return ()
    return (f"no sample for {most_ms:.0f} ms, a guard would trip at {config.stale_ms:g} ms",)


def _bad(health: FtHealth) -> tuple[str, ...]:
    counts = {
        "lost samples": health.lost,
        "wrong checksums": health.checksum_errors,
        "frames that are no new numbers": health.invalid,
        "samples beyond the range": health.saturated,
    }
    return tuple(f"{count} {what}" for what, count in counts.items() if count)


def _stop_channel(
    name: str, config: ForceSensorConfig, robots_asked: threading.Event, ended: threading.Event
) -> Answer:
    channel: StopChannel = _driver(plugins.STOP_CHANNEL, config.stop_channel)
    began_s = now_s()
    channel.open()
    try:
        connect_s = now_s() - began_s
        reports = heard_from(channel, robots_asked, ended)
    finally:
        channel.close()
    path, driver = f"force_sensors.{name}.stop_channel", config.stop_channel.driver
    facts = {"connected after": f"{connect_s:.2f} s", "robot": config.mounted_on}
    if not reports:
        return Answer(path, driver, facts, notes=(f"no report in {LISTEN_S:g} s",))
    times_s = [report.time_s for report in reports]
    gaps_s = _gaps_s(times_s)
    last = reports[-1]
    place = "  ".join(f"{value / MM:.1f}" for value in last.position_m)
    facts["reports"] = f"{len(reports)} in {LISTEN_S:g} s, {spread_ms(gaps_s)}"
    facts["flange"] = f"{place} mm of the base"
    most_ms = 1e3 * max(gaps_s, default=0.0)
    late = most_ms > config.flange_age_ms
    text = f"no report for {most_ms:.0f} ms, a guard would trip at {config.flange_age_ms:g} ms"
    return Answer(path, driver, facts, notes=(text,) if late else ())


def heard_from(
    channel: StopChannel, robots_asked: threading.Event, ended: threading.Event
) -> list[FlangeState]:
    """The reports of a second.

    Heartbeats, for which a dead man waits, go out until ``robots_asked`` or ``ended`` is set.
    """
    found: list[FlangeState] = []
    end_s = now_s() + LISTEN_S
    beat_s = now_s()
    while (now_s() < end_s or not robots_asked.is_set()) and not ended.is_set():
        if now_s() >= beat_s:
            channel.heartbeat()
            beat_s += _BEAT_S
        # A channel that has lost its connection has no descriptor; its next call says what it lost.
        waiting = [descriptor] if (descriptor := channel.fileno()) >= 0 else []
        select.select(waiting, [], [], _LOOK_S)
        report = channel.poll()
        if report is not None and report.time_s < end_s:
            found.append(report)
    return found


def _gaps_s(times_s: list[float]) -> list[float]:
    return [later - earlier for earlier, later in pairwise(times_s)]


def _driver(group: str, config: DeviceConfig) -> Any:
    driver: Any = plugins.load(group, config.driver)
    return driver(driver.Config.model_validate(config.settings))
