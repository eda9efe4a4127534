"""All reasons at once."""

import pytest

from cellctl.cell.readiness import require_full_speed, require_ready
from cellctl.errors.link import StaleData
from cellctl.errors.robot import RobotNotReady, SpeedOverridden
from cellctl.interfaces import RobotMode
from tests.unit.cell.robots import StillRobot


def test_ready_robots_are_ready() -> None:
    require_ready([StillRobot("main"), StillRobot("aux_1")])


def test_every_reason_of_every_robot_is_named() -> None:
    main = StillRobot("main", looks={"mode": RobotMode.MANUAL, "drives_on": False})
    silent = StillRobot("aux_1", faults={"state": StaleData("0.9 s")})
    latched = StillRobot("aux_2", looks={"error_code": 17}, latched=True)
    with pytest.raises(RobotNotReady) as caught:
        require_ready([main, silent, latched])
    text = caught.value.detail
    for reason in ("main: drives off", "main: mode is manual", "aux_1: F207", "latched", "17"):
        assert reason in text


def test_an_emergency_stop_alone_is_enough() -> None:
    with pytest.raises(RobotNotReady, match="emergency stop"):
        require_ready([StillRobot("main", looks={"emergency_stop": True})])


@pytest.mark.parametrize("ratio", [0.0, 0.5, 0.99, 1.1, float("nan")])
def test_any_other_override_than_100_percent_is_a_fault(ratio: float) -> None:
    require_full_speed(StillRobot("main"))
    with pytest.raises(SpeedOverridden, match="F309"):
        require_full_speed(StillRobot("main", looks={"speed_override_ratio": ratio}))
