"""The rate of a force sensor, which the settings of its driver say."""

from cellctl import plugins
from cellctl.config.devices import ForceSensorConfig


def sensor_rate_hz(sensor: ForceSensorConfig) -> float:
    """Samples a second that the sensor is set to: every sensor's ``Config`` has ``rate_hz``."""
    driver = plugins.load(plugins.FT_SENSOR, sensor.driver)
    settings = driver.Config.model_validate(sensor.settings)  # type: ignore[attr-defined]
    return float(settings.rate_hz)


def least_stale_ms(sensor: ForceSensorConfig) -> float:
    """Silence below this is the sensor's own pace: two samples."""
    return 2e3 / sensor_rate_hz(sensor)
