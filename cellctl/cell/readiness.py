"""Checks before every run whether the devices are ready, and reports all reasons at once."""

from collections.abc import Iterable

from cellctl.errors import CellError
from cellctl.errors.robot import RobotNotReady, SpeedOverridden
from cellctl.interfaces import Robot, RobotState

OVERRIDE_BAND_PERCENT = 0.5
"""Controllers report whole percents, so half of one tells 100 from 99."""


def require_ready(robots: Iterable[Robot]) -> None:
    """Raise ``RobotNotReady`` with the reasons of every robot that would refuse a motion."""
    reasons = [f"{robot.name}: {why}" for robot in robots for why in reasons_not_ready(robot)]
    if reasons:
        raise RobotNotReady("; ".join(reasons))


def require_full_speed(robot: Robot) -> None:
    """Raise ``SpeedOverridden`` when the robot moves slower than it is told to.

    Then it would overrun less while its stop is measured than with the override at 100 %, and
    nothing that is planned on times would hold.
    """
    percent = 100.0 * robot.state().speed_override_ratio
    # Written so that a speed that is not a number is refused.
    if not abs(percent - 100.0) < OVERRIDE_BAND_PERCENT:
        raise SpeedOverridden(f"{robot.name}: {percent:.0f} %")


def reasons_not_ready(robot: Robot) -> list[str]:
    """Why a robot would refuse a motion now, in words; none where it would not."""
    try:
        state = robot.state()
    except CellError as error:
        return [str(error)]
    moves = ["it still moves"] if state.moving else []
    return moves + why_not_ready(state)


def why_not_ready(state: RobotState) -> list[str]:
    """What a controller has reported that keeps its arm from moving, in words; none if ready."""
    checks = {
        "emergency stop": state.emergency_stop,
        "drives off": not state.drives_on,
        f"mode is {state.mode.value}": state.mode.value != "remote",
        "stop is latched": state.stop_latched,
        f"controller error {state.error_words or state.error_code}": bool(state.error_code),
    }
    return [text for text, true in checks.items() if true]
