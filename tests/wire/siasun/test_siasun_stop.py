"""Stopping, cancelling and aborts of the SIASUN driver against a scripted peer."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from cellctl.errors.link import (
    LinkLost,
    ReplyTimeout,
)
from cellctl.errors.robot import (
    MotionAborted,
    MotionRejected,
    NotRearmed,
    StopFailed,
)
from drivers.robot.siasun.channels.after_stop import LONGEST_S
from tests.rigs.wire.siasun_cell import LATCHED, THERE_TEXT, Cell, running
from tests.rigs.wire.siasun_peer import POSE


@pytest.fixture
async def cell() -> AsyncIterator[Cell]:
    async with running() as cell:
        yield cell


async def test_an_abort_latches_until_rearm(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"ABRT,1,ESTOP,{POSE}")
    with pytest.raises(MotionAborted, match="emergency stop"):
        await move
    with pytest.raises(NotRearmed):
        await cell.move()
    assert cell.robot.state().stop_latched
    await cell.rearm()
    assert not cell.robot.state().stop_latched
    move = cell.move()
    assert (await cell.cmd.expect()).startswith(f"MOVL,{cell.cmd.session},3,")
    cell.cmd.send("REJ,3,STEP")
    with pytest.raises(MotionRejected):
        await move


async def test_stop_returns_after_standstill(cell: Cell) -> None:
    stopping = asyncio.create_task(cell.robot.stop())
    assert await cell.sta.expect_word("ABORT") == f"ABORT,{cell.sta.session},1"
    assert not stopping.done()
    cell.sta.send(f"STOPD,1,{POSE}")
    await stopping
    with pytest.raises(NotRearmed):
        await cell.move()


async def test_an_unheard_stop_is_repeated_with_its_number(cell: Cell) -> None:
    stopping = asyncio.create_task(cell.robot.stop())
    first = await cell.sta.expect_word("ABORT")
    cell.sta.stat()
    assert await cell.sta.expect_word("ABORT") == first
    cell.sta.send(f"STOPD,1,{POSE}")
    await stopping


async def test_stop_without_confirmation_fails(cell: Cell) -> None:
    stopping = asyncio.create_task(cell.robot.stop())
    await cell.report_until(stopping)
    with pytest.raises(StopFailed, match="standstill"):
        await stopping


async def test_stop_without_link_fails(cell: Cell) -> None:
    await cell.sta.close()
    await cell.cmd.closed()
    with pytest.raises(StopFailed):
        await cell.robot.stop()


async def test_standstill_ends_a_move_whose_abort_got_lost(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    stopping = asyncio.create_task(cell.robot.stop())
    await cell.sta.expect_word("ABORT")
    cell.sta.send(f"STOPD,1,{POSE}")
    await stopping
    with pytest.raises(MotionAborted):
        await move
    cell.cmd.send(f"ABRT,1,STOP,{POSE}")
    await cell.rearm()


async def test_cancelling_a_move_stops_the_robot_first(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    move.cancel()
    await cell.sta.expect_word("ABORT")
    assert not move.done()
    cell.cmd.send(f"ABRT,1,STOP,{POSE}")
    cell.sta.send(f"STOPD,1,{POSE}")
    with pytest.raises(asyncio.CancelledError):
        await move
    with pytest.raises(NotRearmed):
        await cell.move()


async def test_done_before_the_abort_arrives_is_passed_over(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    move.cancel()
    await cell.sta.expect_word("ABORT")
    cell.cmd.send(f"DONE,1,{THERE_TEXT}")
    cell.sta.send(f"STOPD,1,{POSE}")
    with pytest.raises(asyncio.CancelledError):
        await move
    await cell.rearm()


async def test_no_ack_stops_and_drops(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    assert await cell.sta.expect_word("ABORT")
    cell.sta.send(f"STOPD,1,{POSE}")
    with pytest.raises(ReplyTimeout):
        await move
    await cell.cmd.closed()
    with pytest.raises(LinkLost):
        await cell.move()


async def test_disconnect_stops_a_running_move(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    leaving = asyncio.create_task(cell.robot.disconnect())
    await cell.sta.expect_word("ABORT")
    cell.sta.send(f"STOPD,1,{POSE}")
    await leaving
    with pytest.raises(MotionAborted):
        await move


TURNED = "0.50000,-45.00000,90.00000,0.00000,45.00000,0.00000"


@pytest.mark.parametrize(
    "reports",
    [
        pytest.param([{"flags": "REM,0,1,1,1,0,100"}], id="it says so itself"),
        pytest.param(
            [{"flags": LATCHED}, {"flags": LATCHED, "joints": TURNED}], id="by its joints"
        ),
    ],
)
async def test_an_arm_that_moves_on_after_a_confirmed_stop_loses_its_links(
    cell: Cell, reports: list[dict[str, str]], caplog: pytest.LogCaptureFixture
) -> None:
    stopping = asyncio.create_task(cell.robot.stop())
    await cell.sta.expect_word("ABORT")
    cell.sta.send(f"STOPD,1,{POSE}")
    await stopping
    *first, last = reports
    for report in first:
        cell.sta.stat(**report)
    closed = asyncio.create_task(cell.sta.closed())
    await cell.report_until(closed, **last)
    await cell.cmd.closed()
    assert "has confirmed a stop and reports that it moves on" in caplog.text
    with pytest.raises(LinkLost):
        cell.robot.state()
    with pytest.raises(StopFailed):
        await cell.robot.stop()


async def test_an_arm_may_be_jogged_after_a_stop(cell: Cell) -> None:
    stopping = asyncio.create_task(cell.robot.stop())
    await cell.sta.expect_word("ABORT")
    cell.sta.send(f"STOPD,1,{POSE}")
    await stopping
    cell.sta.stat(flags=LATCHED)
    jogging = asyncio.create_task(asyncio.sleep(2 * LONGEST_S))
    await cell.report_until(jogging, flags="MAN,0,1,1,1,0,100", joints=TURNED)
    assert cell.robot.state(0.1).moving
