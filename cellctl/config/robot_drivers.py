"""What the driver of a robot says about its settings, before any robot is connected."""

from typing import Any, cast

from cellctl import plugins
from cellctl.config.devices import RobotConfig
from cellctl.geometry.box import Box
from cellctl.interfaces import Robot


def robot_driver(robot: RobotConfig) -> tuple[type[Robot], Any]:
    """Driver class and its checked settings; raises ``UnknownDriver`` and pydantic's error."""
    driver: Any = plugins.load(plugins.ROBOT, robot.driver)
    return cast(type[Robot], driver), driver.Config.model_validate(robot.settings)


def flange_box(robot: RobotConfig) -> Box | None:
    """The box in its base that the flange must stay in; None where the settings give none.

    A driver that bounds its targets has ``workspace_min_mm`` and ``workspace_max_mm``.
    """
    _, settings = robot_driver(robot)
    lower = getattr(settings, "workspace_min_mm", None)
    upper = getattr(settings, "workspace_max_mm", None)
    return None if lower is None or upper is None else Box.from_mm(lower, upper)
