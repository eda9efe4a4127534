"""Time limits so short that every answer is late, exposures so long that nothing stands still."""

from collections.abc import Iterator, Set

from cellctl.config.cell import CellConfig
from cellctl.config.devices import DeviceConfig, ForceSensorConfig
from cellctl.config.document.leaves import leaves
from cellctl.config.driver_settings import least_stale_ms
from cellctl.config.issue import ConfigIssue, WrittenValue

_LEAST_S = 0.02
"""Twice the pause that an ordinary Linux PC under load takes now and then."""
_LEAST_DEADMAN_S = 0.1
"""Four heartbeats go out in this time; more often no PC sends them without a miss."""
_LONGEST_EXPOSURE_S = 1.0
_NAMES = ("silence_s", "stale_s", "max_lag_s", "max_watchdog_s")
_PERIODS = 3.0
"""Reports that may be late or lost before something is given up."""


def wait_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Limits of silence, dead men and timeouts below what network and PC need; 0 has a meaning of
    its own where a driver allows it. ``bad`` holds the paths of devices that are wrong themselves.
    """
    for key, value in leaves(cell.model_dump()):
        name = key.rsplit(".", 1)[-1]
        if not isinstance(value, int | float) or isinstance(value, bool):
            continue
        least_s = _LEAST_DEADMAN_S if name == "max_deadman_s" else _LEAST_S
        watched = name in _NAMES or name == "max_deadman_s" or name.endswith("timeout_s")
        if watched and 0.0 < value < least_s:
            allowed = f"at least {least_s:g} seconds: a PC that pauses for less is in order"
            yield ConfigIssue(key, f"{value:g}", allowed)
        if name == "exposure_s" and value > _LONGEST_EXPOSURE_S:
            allowed = f"at most {_LONGEST_EXPOSURE_S:g} second; this looks like milliseconds"
            yield ConfigIssue(key, f"{value:g}", allowed)
    for key, (_, device) in cell.devices().items():
        if ".".join(key.split(".")[:2]) not in bad:
            yield from _below_period(key, device)
    for key, sensor in cell.force_sensors.items():
        if f"force_sensors.{key}" not in bad:
            yield from _below_samples(f"force_sensors.{key}", sensor)


def _below_period(path: str, device: DeviceConfig) -> Iterator[ConfigIssue]:
    """Silences shorter than the reports that they wait for, by the names that drivers use."""
    settings = device.settings
    silence_s, stale_s = settings.get("silence_s"), settings.get("stale_s")
    if silence_s is not None and stale_s is not None and stale_s > silence_s:
        # The link is given up before a state can become so old.
        allowed = f"at most {silence_s:g}, after which the device counts as lost"
        against = (WrittenValue(f"{path}.settings.silence_s", f"{silence_s:g}"),)
        yield ConfigIssue(f"{path}.settings.stale_s", f"{stale_s:g}", allowed, against=against)
    period_s = settings.get("poll_period_s")
    for name, value_s in (("stale_s", stale_s), ("silence_s", silence_s)):
        if period_s is not None and value_s is not None and value_s < _PERIODS * period_s:
            allowed = (
                f"at least {_PERIODS * period_s:g}, three times poll_period_s: one late report is "
                "no lost device"
            )
            yield ConfigIssue(f"{path}.settings.{name}", f"{value_s:g}", allowed)


def _below_samples(path: str, sensor: ForceSensorConfig) -> Iterator[ConfigIssue]:
    # Boxes that put several samples into one frame send frames as much more seldom.
    least_ms = least_stale_ms(sensor) * sensor.settings.get("points", 1)
    if sensor.stale_ms < least_ms:
        allowed = f"at least {least_ms:g}, two frames of the sensor"
        yield ConfigIssue(f"{path}.stale_ms", f"{sensor.stale_ms:g}", allowed)
