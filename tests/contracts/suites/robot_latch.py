"""What every robot must do: a stop holds, whoever forgets it, and a lost link is one."""

import asyncio
import contextlib

import pytest

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError
from cellctl.errors.robot import NotRearmed, StopFailed
from tests.contracts.suites.robot_bench import RobotBench, RobotClauses, within

_SLOWLY_M_S = 0.008
"""The way of a long motion takes 10 s at this speed: longer than a stop may wait."""


class RobotLatch(RobotClauses):
    """Clauses of the latch."""

    async def holds(self, bench: RobotBench, commands: int) -> None:
        """The latch is shown, and nothing moves."""
        assert bench.robot.state().stop_latched
        with pytest.raises(NotRearmed):
            await within(5.0, self.begun_at_last(bench))
        assert bench.commands() == commands
        assert not bench.moving()

    async def begun_at_last(self, bench: RobotBench) -> None:
        """A move; a controller may bring one of its channels back later than the other."""
        while True:
            with contextlib.suppress(LinkError):
                await self.move(bench, 2.0)
                return
            await asyncio.sleep(0.05)

    async def test_connecting_releases_no_latch(self, connected: RobotBench) -> None:
        """Neither by what it sends nor by what it forgets, on a new link and on one that stands."""
        await within(2.0, connected.robot.stop())
        await self.reconnect(connected)
        await self.holds(connected, 0)
        await connected.robot.disconnect()
        await self.reconnect(connected)
        await self.holds(connected, 0)

    async def test_the_driver_remembers_a_stop_itself(self, connected: RobotBench) -> None:
        """A controller may lose its latch: somebody at the panel, another client, a restart."""
        await within(2.0, connected.robot.stop())
        connected.release_at_the_panel()
        await asyncio.sleep(0.2)  # the controller reports that it has none
        await self.holds(connected, 0)
        await self.rearm(connected)
        await within(3.0, self.move(connected, 2.0))

    async def test_a_lost_link_is_latched_until_rearmed(self, connected: RobotBench) -> None:
        """Nobody has seen the arm meanwhile. The controller's own latch is not counted on."""
        move = await self.begin(connected)
        connected.cut()
        with pytest.raises(LinkError):
            await within(0.3, move)
        await self.reconnect(connected)
        async with asyncio.timeout(2.0):
            while connected.moving():  # noqa: ASYNC110  the arm tells nobody
                await asyncio.sleep(0.01)
        connected.release_at_the_panel()
        await asyncio.sleep(0.2)  # the controller reports that it has none
        await self.holds(connected, 1)

    async def test_a_stop_that_is_not_confirmed_ends_every_sign_of_life(
        self, connected: RobotBench
    ) -> None:
        """The dead man of the controller is then what stops the arm, and heartbeats would keep it
        from that. The latch stays when the link is back."""
        move = await self.begin(connected, _SLOWLY_M_S)
        connected.ignore_stops()
        with pytest.raises(StopFailed):
            await within(5.0, connected.robot.stop())
        failed_s = now_s()
        with pytest.raises(CellError):
            await within(1.0, move)
        while connected.moving():
            assert now_s() - failed_s < 1.5, "something still tells the controller that all is well"
            await asyncio.sleep(0.01)
        await self.reconnect(connected)
        await self.holds(connected, 1)

    async def test_a_motion_that_the_controller_refuses_is_raised(
        self, connected: RobotBench
    ) -> None:
        before = connected.flange()
        connected.refuse_motion()
        move = self.move(connected, 2.0)
        assert (await asyncio.wait({move}, timeout=3.0))[0], "still waits for its end"
        assert isinstance(move.exception(), CellError)
        assert not connected.moving()
        assert (connected.flange().translation == before.translation).all()

    async def test_reports_that_stay_away_end_a_motion(self, connected: RobotBench) -> None:
        """Nobody sees the arm any more, long before a slow motion would be over. Whether it stops
        is up to its controller."""
        move = await self.begin(connected, _SLOWLY_M_S)
        connected.freeze()
        assert (await asyncio.wait({move}, timeout=5.0))[0], "still waits for its end"
        assert isinstance(move.exception(), CellError)
