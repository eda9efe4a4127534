"""What every robot must do: figures mean the same at both ends, and the panel counts."""

import asyncio
from collections.abc import Awaitable

import numpy as np
import pytest

from cellctl.clock import now_s
from cellctl.errors.link import StaleData
from cellctl.errors.robot import ControllerFault, NotRearmed, RobotNotReady, TargetOutOfBounds
from cellctl.interfaces.robot import RobotMode, RobotState
from tests.contracts.suites.robot_bench import Panel, RobotBench, RobotClauses, within

_LEAST, _MOST = 0.75, 4.0
"""Of the time that a motion must take: arms have ramps and dead times, and a PC may be busy. A unit
that is wrong makes a factor of ten or more."""


class RobotFigures(RobotClauses):
    """Clauses of figures and of the panel."""

    @staticmethod
    async def takes(due_s: float, motion: Awaitable[object]) -> None:
        """As long as the arm of the bench must need, by the speed that it was told."""
        begun_s = now_s()
        await within(_MOST * due_s + 1.0, motion)
        assert _LEAST * due_s < now_s() - begun_s < _MOST * due_s

    # --- how fast

    async def test_the_arm_goes_as_fast_as_it_was_told(self, connected: RobotBench) -> None:
        robot = connected.robot
        there = self.target(connected, 40.0)
        await self.takes(0.85, robot.move_linear(there, speed_m_s=0.05, acceleration_m_s2=1.0))
        a_step = self.target(connected, -0.3)
        await self.takes(0.3, robot.step(a_step, speed_m_s=0.001))

    async def test_the_arm_gets_faster_as_it_was_told(self, connected: RobotBench) -> None:
        """Half of this motion is ramp, up and down."""
        there = self.target(connected, 20.0)
        move = connected.robot.move_linear(there, speed_m_s=0.05, acceleration_m_s2=0.1)
        await self.takes(0.9, move)

    async def test_joints_turn_as_fast_as_they_were_told(self, connected: RobotBench) -> None:
        robot, ratio, due_s = connected.robot, 0.05, 0.5
        turned_rad = np.array([ratio * due_s * connected.joint_speed_rad_s, *[0.0] * 5])
        there_rad = robot.state().joints_rad + turned_rad
        await self.takes(due_s, robot.move_joint(there_rad, speed_ratio=ratio))

    # --- how far

    async def test_a_step_does_not_leave_the_bounds(self, connected: RobotBench) -> None:
        """Step by step an arm gets as far as by a move."""
        robot, fast = connected.robot, connected.max_speed_m_s
        await within(6.0, robot.move_linear(connected.edge, speed_m_s=fast, acceleration_m_s2=1.0))
        assert robot.state().distance_to(connected.beyond_edge)[0] <= 0.0003, "of the bench"
        with pytest.raises(TargetOutOfBounds):
            await robot.step(connected.beyond_edge, speed_m_s=0.01)
        assert connected.commands() == 1

    async def test_bounds_are_stated(self, bench: RobotBench) -> None:
        """`cellctl check` holds cell file and recipes against them, before an arm is there."""
        stated = bench.stated_bounds()
        assert stated.speed_m_s == pytest.approx(bench.max_speed_m_s)
        assert stated.flange_box is not None
        assert stated.flange_box.holds(bench.edge.translation)
        assert not stated.flange_box.holds(bench.outside.translation)

    # --- what is reported

    async def test_no_report_is_younger_than_it_is(self, connected: RobotBench) -> None:
        with pytest.raises(StaleData):
            connected.robot.state(0.0)

    async def test_the_override_is_a_ratio(self, connected: RobotBench) -> None:
        assert connected.robot.state().speed_override_ratio == 1.0
        ratio = connected.turn_override_down()
        assert ratio < 1.0
        async with asyncio.timeout(2.0):
            while connected.robot.state().speed_override_ratio != ratio:  # noqa: ASYNC110
                await asyncio.sleep(0.01)

    @pytest.mark.parametrize("panel", Panel)
    async def test_an_arm_that_is_not_ready_is_not_moved(
        self, connected: RobotBench, panel: Panel
    ) -> None:
        robot, here = connected.robot, self.target(connected, 2.0)
        connected.set_panel(panel)
        async with asyncio.timeout(2.0):
            while not shows(robot.state(), panel):  # noqa: ASYNC110  no event for it
                await asyncio.sleep(0.01)
        assert not robot.state().ready
        with pytest.raises((RobotNotReady, NotRearmed, ControllerFault)):
            await robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=1.0)
        assert connected.commands() == 0


def shows(state: RobotState, panel: Panel) -> bool:
    """Whether a report says what was done at the panel."""
    return {
        Panel.EMERGENCY_STOP: state.emergency_stop,
        Panel.MANUAL: state.mode is RobotMode.MANUAL,
        Panel.DRIVES_OFF: not state.drives_on,
        Panel.ERROR: state.error_code != 0,
    }[panel]
