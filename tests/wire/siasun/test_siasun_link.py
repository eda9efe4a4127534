"""Links of the SIASUN driver against a scripted peer: loss, silence, violations, coming back."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from cellctl.errors.link import (
    LinkLost,
    ProtocolViolation,
    StaleData,
)
from cellctl.errors.robot import (
    MotionRejected,
    NotRearmed,
)
from tests.rigs.wire.siasun_cell import LATCHED, Cell, running
from tests.rigs.wire.siasun_peer import POSE, Peer


@pytest.fixture
async def cell() -> AsyncIterator[Cell]:
    async with running() as cell:
        yield cell


@pytest.mark.parametrize("channel", ["cmd", "sta"])
async def test_link_loss_fails_the_running_move_at_once(cell: Cell, channel: str) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    await getattr(cell, channel).close()
    async with asyncio.timeout(0.2):
        with pytest.raises(LinkLost):
            await move


async def test_after_reconnect_nothing_moves_before_rearm(cell: Cell) -> None:
    old = int(cell.cmd.session)
    port = cell.robot._config.command_port
    await cell.cmd.close()
    await cell.back(port)
    assert int(cell.cmd.session) == old % 999_999 + 1
    with pytest.raises(NotRearmed):
        await cell.move()
    await cell.rearm()


async def test_losing_the_state_drops_both(cell: Cell) -> None:
    await cell.sta.close()
    await cell.cmd.closed()
    with pytest.raises(LinkLost):
        cell.robot.state()


async def test_a_silent_robot_is_lost() -> None:
    async with running(silence_s=0.1, stale_s=0.05) as cell:
        await cell.sta.closed()
        with pytest.raises(LinkLost):
            cell.robot.state()


async def test_repeated_reports_go_stale() -> None:
    async with running(silence_s=10.0, stale_s=0.1) as cell:
        cell.sta.stat()
        deadline = asyncio.get_running_loop().time() + 0.15
        while asyncio.get_running_loop().time() < deadline:
            cell.sta.count -= 1
            cell.sta.stat()
            await cell.sta.expect_word("BEAT")
        with pytest.raises(StaleData):
            cell.robot.state(0.1)
        with pytest.raises(StaleData):
            await cell.move()


async def test_heartbeats_come_well_within_the_dead_man(cell: Cell) -> None:
    loop = asyncio.get_running_loop()
    await cell.sta.expect_word("BEAT")
    start = loop.time()
    numbers = []
    for _ in range(4):
        cell.sta.stat()
        numbers.append(int((await cell.sta.expect_word("BEAT")).split(",")[2]))
    assert numbers == list(range(numbers[0], numbers[0] + 4))
    assert loop.time() - start < 4 * 0.1


@pytest.mark.parametrize("body", ["DONE,7," + POSE, "STOPD,1," + POSE, "HELLO,SJL,2", "NOISE"])
async def test_a_violation_on_cmd_drops_and_latches(cell: Cell, body: str) -> None:
    cell.cmd.send(body)
    await cell.cmd.closed()
    await cell.back(cell.robot._config.command_port)
    with pytest.raises(NotRearmed, match="F203"):
        await cell.move()


async def test_a_violation_fails_the_running_move(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    cell.cmd.writer.write(b"DONE,1,1900.0000,0.0000,930.0000,90.0000,0.0000,180.0000*00\n")
    with pytest.raises(ProtocolViolation):
        await move


async def test_a_second_connection_is_closed_while_the_first_lives(cell: Cell) -> None:
    second = await Peer.connect(cell.robot._config.command_port)
    await second.closed()
    await second.close()
    move = cell.move()
    assert (await cell.cmd.expect()).startswith("MOVL")
    cell.cmd.send("REJ,1,LIMIT")
    with pytest.raises(MotionRejected):
        await move


async def test_rearm_is_void_when_the_link_breaks_meanwhile(cell: Cell) -> None:
    rearming = asyncio.create_task(cell.robot.rearm())
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{POSE}")
    await cell.cmd.close()
    await cell.report_until(rearming, flags=LATCHED)
    with pytest.raises((StaleData, NotRearmed, LinkLost)):
        await rearming
    assert cell.robot.state().stop_latched
