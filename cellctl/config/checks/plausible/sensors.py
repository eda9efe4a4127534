"""Force sensors that are too slow or too weak for their guard."""

import math
from collections.abc import Iterator, Set

from cellctl.config.cell import CellConfig
from cellctl.config.devices import ForceSensorConfig
from cellctl.config.driver_settings import (
    LEAST_RATE_HZ,
    measuring_range,
    sensor_rate_hz,
    sensor_remarks_of,
)
from cellctl.config.issue import ConfigIssue

_MOST_OVER_OTHERS = 5.0
"""Greatest ratio of two ranges in a sensor's data sheet: along its axis it carries about twice as
much as across."""
NOISE_SHARE = 1e-4
"""Of the range: what the amplifier of a sensor leaves as noise in ten samples."""
_LEVERS_M = (0.003, 1.0)
"""Ranges of a moment over those of the forces: a sensor carries moments of its forces at about its
own radius, from that of a fingertip to that of a turntable; N·mm make metres of it."""
_USABLE = 0.9
"""Share of a range that a limit may ask for: the zero offset of a sensor and the weight of what
hangs on it lie within the same range."""


def sensor_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Rates below what a guard needs, and limits beyond what the sensor can say.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for name, sensor in cell.force_sensors.items():
        path = f"force_sensors.{name}"
        if path in bad:
            continue
        rate_hz = sensor_rate_hz(sensor)
        if rate_hz < LEAST_RATE_HZ:
            allowed = f"at least {LEAST_RATE_HZ:g} samples a second, for the guard to stop in time"
            yield ConfigIssue(f"{path}.settings.rate_hz", f"{rate_hz:g}", allowed)
        yield from _range(path, sensor)


def _range(path: str, sensor: ForceSensorConfig) -> Iterator[ConfigIssue]:
    measuring = measuring_range(sensor)
    if not measuring:
        return
    for three in (measuring[:3], measuring[3:]):
        if max(three) > _MOST_OVER_OTHERS * min(three):
            # With a range that the sensor does not have, a clipped force is taken for a true one.
            allowed = (
                f"three forces, then three moments, of the sensor's data sheet; {max(three):g} is "
                f"more than {_MOST_OVER_OTHERS:g} times {min(three):g}"
            )
            yield ConfigIssue(f"{path}.settings.range", str(measuring), allowed)
            return
    limits = {
        "free_force_n": (sensor.free_force_n, min(measuring[:3]), "N"),
        "free_moment_n_m": (sensor.free_moment_n_m, min(measuring[3:]), "N·m"),
    }
    for key, (limit, most, unit) in limits.items():
        if limit > _USABLE * most:
            # The sensor clips before the limit: the guard would never see it passed.
            # Rounded up: what is written here has to be enough when somebody writes it.
            least = math.ceil(10.0 * limit / _USABLE) / 10.0
            allowed = (
                f"at least {least:g} {unit} in each axis, for {path}.{key} = {limit:g} "
                "and a tenth that offset and weight take, or a lower limit"
            )
            yield ConfigIssue(f"{path}.settings.range", str(measuring), allowed)
            return
    lever_m = max(measuring[3:]) / min(measuring[:3])
    if not _LEVERS_M[0] <= lever_m <= _LEVERS_M[1]:
        allowed = (
            f"three forces in N, then three moments in N·m; {max(measuring[3:]):g} N·m at "
            f"{min(measuring[:3]):g} N is a lever of {lever_m:g} m, which no such sensor has; or "
            "were the moments in N·mm?"
        )
        yield ConfigIssue(f"{path}.settings.range", str(measuring), allowed)


def sensor_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Settings that the driver of a sensor wants to be looked at again."""
    for name, sensor in cell.force_sensors.items():
        for key, said in sensor_remarks_of(sensor).items():
            value = repr(sensor.settings.get(key))
            yield ConfigIssue(f"force_sensors.{name}.settings.{key}", value, said)
