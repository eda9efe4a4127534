"""What the driver of a robot says about its settings, before any robot is connected."""

from typing import Any, cast

from cellctl import plugins
from cellctl.config.devices import RobotConfig
from cellctl.interfaces import MotionBounds, Robot


def robot_driver(robot: RobotConfig) -> tuple[type[Robot], Any]:
    """Driver class and its checked settings; raises ``UnknownDriver`` and pydantic's error."""
    driver: Any = plugins.load(plugins.ROBOT, robot.driver)
    return cast(type[Robot], driver), driver.Config.model_validate(robot.settings)


def motion_bounds(robot: RobotConfig) -> MotionBounds:
    """What the driver refuses with these settings; raises like ``robot_driver``."""
    driver, settings = robot_driver(robot)
    return driver.bounds(settings)
