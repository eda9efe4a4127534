"""The PC's contact in the permit loop of a controller that works by the text of the protocol."""

from collections.abc import AsyncIterator

import pytest

from cellctl.errors.robot import MotionAborted, NotRearmed
from tests.rigs.wire.any_rig import move, rearm, until_moving, within
from tests.rigs.wire.sjl_rig import Rig, sjl_rig


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    async with sjl_rig() as rig:
        await rig.connect()
        yield rig


def contact(rig: Rig, *, closed: bool) -> None:
    rig.controller.logic.contact_closed = lambda: closed


async def test_it_stops_a_motion_and_latches(rig: Rig) -> None:
    moving = move(rig, 100.0, 0.05)
    await until_moving(rig)
    contact(rig, closed=False)
    with pytest.raises(MotionAborted, match="STOP"):
        await within(2.0, moving)
    assert rig.arm.cut_short
    assert not rig.controller.moving()
    contact(rig, closed=True)
    await rig.robot._state.wait(lambda status: status.latched, 1.0)
    await rearm(rig)
    await within(2.0, move(rig, 1.0))


async def test_an_open_one_refuses_the_release(rig: Rig) -> None:
    contact(rig, closed=False)
    await rig.robot._state.wait(lambda status: status.latched, 1.0)
    with pytest.raises(NotRearmed, match="LATCHED"):
        await rig.robot.rearm()
