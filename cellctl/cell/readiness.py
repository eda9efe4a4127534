"""Are the devices ready for a run? Asked before every run, answered with all reasons at once."""

from collections.abc import Iterable

from cellctl.errors import CellError
from cellctl.errors.robot import RobotNotReady
from cellctl.interfaces import Robot, RobotState


def require_ready(robots: Iterable[Robot]) -> None:
    """Raise ``RobotNotReady`` with the reasons of every robot that would refuse a motion."""
    reasons = [f"{robot.name}: {why}" for robot in robots for why in _reasons(robot)]
    if reasons:
        raise RobotNotReady("; ".join(reasons))


def _reasons(robot: Robot) -> list[str]:
    try:
        state = robot.state()
    except CellError as error:
        return [str(error)]
    return [] if state.ready else _why_not(state)


def _why_not(state: RobotState) -> list[str]:
    checks = {
        "emergency stop": state.emergency_stop,
        "drives off": not state.drives_on,
        f"mode is {state.mode.value}": state.mode.value != "remote",
        "stop is latched": state.stop_latched,
        f"controller error {state.error_code}": bool(state.error_code),
    }
    return [text for text, true in checks.items() if true]
