"""What drivers say about their settings and abilities, before a connection."""

from collections.abc import Mapping
from typing import Any, cast

from pydantic import BaseModel

from cellctl import plugins
from cellctl.config.devices import (
    CameraConfig,
    DeviceConfig,
    DigitalIoConfig,
    ForceSensorConfig,
    RobotConfig,
)
from cellctl.errors.config import UnknownDriver
from cellctl.geometry.pose import MM
from cellctl.interfaces import DigitalIo, IoNames, MotionBounds, Robot
from cellctl.interfaces.exposure import AdjustableExposure
from cellctl.interfaces.ft_sensor import FtSensor


def checked_settings(group: str, device: DeviceConfig) -> BaseModel:
    """The settings with their defaults; raises ``UnknownDriver`` and pydantic's error.

    ``group`` is that of its entry point (``cellctl.plugins``).
    """
    driver: Any = plugins.load(group, device.driver)
    return cast(BaseModel, driver.Config.model_validate(device.settings))


def robot_driver(robot: RobotConfig) -> tuple[type[Robot], Any]:
    """Driver class and its checked settings; raises ``UnknownDriver`` and pydantic's error."""
    driver: Any = plugins.load(plugins.ROBOT, robot.driver)
    return cast(type[Robot], driver), driver.Config.model_validate(robot.settings)


def motion_bounds(robot: RobotConfig) -> MotionBounds:
    """What the driver refuses with these settings; raises like ``robot_driver``."""
    driver, settings = robot_driver(robot)
    return driver.bounds(settings)


def first_link_mm(robot: RobotConfig) -> tuple[float | None, float | None]:
    """Height of the A2 axis above the base plane and its distance from the A1 axis (D-H d1 and a1
    in mm): as the robot states them, else as its driver's settings describe the arm; None where
    neither does."""
    driver, settings = robot_driver(robot)
    chain = driver.chain(settings)
    d1_mm, a1_mm = (None, None) if chain is None else (chain.dh[0, 1] / MM, chain.dh[0, 2] / MM)
    return (
        d1_mm if robot.d1_mm is None else robot.d1_mm,
        a1_mm if robot.a1_mm is None else robot.a1_mm,
    )


def reach_m(robot: RobotConfig) -> float | None:
    """Length of all links, farther than which no pose comes; None where nothing describes them."""
    driver, settings = robot_driver(robot)
    chain = driver.chain(settings)
    return None if chain is None else chain.length_m


def sets_exposures(group: str, camera: CameraConfig) -> bool:
    """Whether the driver can set an exposure; True for one that is unknown, which is another fault.

    ``group`` is that of its entry point (``cellctl.plugins``).
    """
    try:
        driver: Any = plugins.load(group, camera.driver)
    except UnknownDriver:
        return True
    return driver.set_exposure is not AdjustableExposure.set_exposure


def measuring_range(sensor: ForceSensorConfig) -> list[float]:
    """Three forces in N, then three moments in N·m; empty where the settings name none.

    By convention a driver whose sensor has a measuring range names it ``range``.
    """
    written = sensor.settings.get("range")
    return written if isinstance(written, list) and len(written) == 6 else []


def sensor_rate_hz(sensor: ForceSensorConfig) -> float:
    """Samples a second that the sensor is set to: every sensor's ``Config`` has ``rate_hz``."""
    driver = plugins.load(plugins.FT_SENSOR, sensor.driver)
    settings = driver.Config.model_validate(sensor.settings)  # type: ignore[attr-defined]
    return float(settings.rate_hz)


def sensor_remarks_of(sensor: ForceSensorConfig) -> Mapping[str, str]:
    """What the driver of a sensor says of its settings, by their keys."""
    driver: Any = plugins.load(plugins.FT_SENSOR, sensor.driver)
    return cast(type[FtSensor], driver).remarks(driver.Config.model_validate(sensor.settings))


LEAST_RATE_HZ = 100.0
"""A tenth of a guard's usual rate: at 10 ms from sample to sample an arm at the speed of a touch
(below 1 mm/s) has gone a hundredth of a millimetre, at 100 ms enough for the whole limit."""


def least_stale_ms(sensor: ForceSensorConfig) -> float:
    """Silence below this is the sensor's own pace: two samples."""
    return 2e3 / sensor_rate_hz(sensor)


def io_names(io: DigitalIoConfig) -> IoNames | None:
    """Names of its inputs and outputs, None where its driver knows them only from the device;
    raises like ``robot_driver``."""
    driver: Any = plugins.load(plugins.DIGITAL_IO, io.driver)
    return cast(type[DigitalIo], driver).names(driver.Config.model_validate(io.settings))
