"""The SIASUN driver against a scripted peer, record by record."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import numpy as np
import pytest

from cellctl.errors.link import (
    ConnectTimeout,
    LinkLost,
    PortInUse,
    ProtocolViolation,
    ReplyTimeout,
    StaleData,
    VersionMismatch,
)
from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    RobotNotReady,
    StopFailed,
    TargetOutOfBounds,
)
from cellctl.geometry.pose import pose_from_xyzabc, pose_to_xyzabc
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.driver import SiasunRobot
from tests.wire.siasun_peer import POSE, Peer, free_ports

HERE = [1900.0, -0.125, 927.0, 90.0, 0.0, 180.0]
THERE = [1900.0, 0.0, 930.0, 90.0, 0.0, 180.0]
THERE_TEXT = "1900.0000,0.0000,930.0000,90.0000,0.0000,180.0000"
MOVING = "REM,0,1,1,0,0,100"
LATCHED = "REM,0,1,0,1,0,100"


def config(**changes: object) -> SiasunConfig:
    command_port, state_port = free_ports(2)
    settings: dict[str, object] = {
        "command_port": command_port,
        "state_port": state_port,
        "robot_name": "SR500A",
        "connect_timeout_s": 2.0,
        "reply_timeout_s": 0.2,
        "stop_timeout_s": 0.5,
        "workspace_min_mm": (1000.0, -500.0, 800.0),
        "workspace_max_mm": (2000.0, 500.0, 1500.0),
        "max_speed_mm_s": 250.0,
    }
    return SiasunConfig.model_validate(settings | changes)


@dataclass
class Cell:
    """A connected driver and the scripted ends of its channels."""

    robot: SiasunRobot
    cmd: Peer
    sta: Peer

    async def rearm(self) -> None:
        """Play the controller's part in a re-arm."""
        rearming = asyncio.create_task(self.robot.rearm())
        word, session, seq = (await self.cmd.expect()).split(",")
        assert (word, session) == ("REARM", self.cmd.session)
        self.cmd.send(f"ACK,{seq}")
        self.cmd.send(f"DONE,{seq},{POSE}")
        await self.report_until(rearming)
        await rearming

    async def report_until(self, task: "asyncio.Task[object]", **stat: str) -> None:
        """Send reports as a controller does until a task of the driver has ended."""
        while not task.done():
            self.sta.stat(**stat)
            await asyncio.wait({task}, timeout=0.01)

    async def back(self, port: int) -> None:
        """The robot's CMD channel comes back."""
        await self.cmd.close()
        self.cmd = await Peer.greeted(port, "CMD")
        self.sta.stat()

    def move(self, target: list[float] = THERE) -> "asyncio.Task[object]":
        move = self.robot.move_linear(
            pose_from_xyzabc(target), speed_m_s=0.05, acceleration_m_s2=0.2
        )
        return asyncio.create_task(move)


@asynccontextmanager
async def running(**changes: object) -> AsyncIterator[Cell]:
    settings = config(**changes)
    robot = SiasunRobot("main", settings)
    connecting = asyncio.create_task(robot.connect())
    cmd = await Peer.greeted(settings.command_port, "CMD")
    sta = await Peer.greeted(settings.state_port, "STA")
    sta.stat()
    await connecting
    cell = Cell(robot, cmd, sta)
    try:
        yield cell
    finally:
        await robot.disconnect()
        await cell.cmd.close()
        await cell.sta.close()


@pytest.fixture
async def cell() -> AsyncIterator[Cell]:
    async with running() as cell:
        yield cell


async def test_state_is_si(cell: Cell) -> None:
    state = cell.robot.state()
    assert pose_to_xyzabc(state.base_T_flange) == pytest.approx(HERE)
    assert np.degrees(state.joints_rad) == pytest.approx([0, -45, 90, 0, 45, 0])
    assert state.ready


async def test_move(cell: Cell) -> None:
    move = cell.move()
    session = cell.cmd.session
    assert await cell.cmd.expect() == f"MOVL,{session},1,{THERE_TEXT},50.0000,200.0000"
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{THERE_TEXT}")
    cell.sta.stat(MOVING)
    await cell.report_until(move, pose=THERE_TEXT)
    state = await move
    assert pose_to_xyzabc(state.base_T_flange) == pytest.approx(THERE)  # type: ignore[attr-defined]
    assert not state.moving  # type: ignore[attr-defined]


async def test_only_one_move_at_a_time(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    with pytest.raises(MotionRejected):
        await cell.move()
    cell.cmd.send("REJ,1,LIMIT")
    with pytest.raises(MotionRejected, match="joint limit"):
        await move


@pytest.mark.parametrize(
    ("reason", "fault"),
    [("REACH", MotionRejected), ("ESTOP", RobotNotReady), ("LATCHED", NotRearmed),
     ("ERROR", ControllerFault), ("LOAD", MotionRejected), ("NEWWORD", MotionRejected)],
)  # fmt: skip
async def test_rejections(cell: Cell, reason: str, fault: type[Exception]) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send(f"REJ,1,{reason}")
    with pytest.raises(fault, match=reason):
        await move


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


@pytest.mark.parametrize(
    ("flags", "fault"),
    [("MAN,0,1,0,0,0,100", RobotNotReady), ("REM,1,0,0,0,0,100", RobotNotReady),
     ("REM,0,0,0,0,0,100", RobotNotReady), (LATCHED, NotRearmed),
     ("REM,0,1,0,0,4001,100", ControllerFault)],
)  # fmt: skip
async def test_no_motion_is_sent_when_not_ready(
    cell: Cell, flags: str, fault: type[Exception]
) -> None:
    waiting = asyncio.create_task(cell.robot._state.wait(lambda _: True, 1.0))
    await asyncio.sleep(0)
    cell.sta.stat(flags)
    await waiting
    with pytest.raises(fault):
        await cell.move()


@pytest.mark.parametrize(
    "target",
    [[2000.1, 0, 900, 90, 0, 180], [1900, -500.1, 900, 90, 0, 180], [1900, 0, 799, 90, 0, 180]],
)
async def test_targets_out_of_the_workspace_are_not_sent(cell: Cell, target: list[float]) -> None:
    with pytest.raises(TargetOutOfBounds):
        await cell.move(target)
    allowed = cell.move()
    assert (await cell.cmd.expect()).split(",")[2] == "1"
    cell.cmd.send("REJ,1,LIMIT")
    with pytest.raises(MotionRejected):
        await allowed


async def test_speeds_and_steps_are_bounded(cell: Cell) -> None:
    robot, there = cell.robot, pose_from_xyzabc(THERE)
    with pytest.raises(TargetOutOfBounds, match="speed"):
        await robot.move_linear(there, speed_m_s=0.251, acceleration_m_s2=0.2)
    with pytest.raises(TargetOutOfBounds, match="speed"):
        await robot.move_linear(there, speed_m_s=float("nan"), acceleration_m_s2=0.2)
    with pytest.raises(TargetOutOfBounds, match="acceleration"):
        await robot.move_linear(there, speed_m_s=0.1, acceleration_m_s2=10.0)
    with pytest.raises(TargetOutOfBounds, match="step"):
        await robot.step(there, speed_m_s=0.001)
    turned = pose_from_xyzabc([*HERE[:3], 90.6, 0.0, 180.0])
    with pytest.raises(TargetOutOfBounds, match="turns"):
        await robot.step(turned, speed_m_s=0.001)
    with pytest.raises(TargetOutOfBounds, match="joint speed"):
        await robot.move_joint(np.zeros(6), speed_ratio=0.5)
    with pytest.raises(TargetOutOfBounds, match="joints"):
        await robot.move_joint(np.full(6, np.nan), speed_ratio=0.1)


async def test_a_motion_that_ends_elsewhere_latches(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{POSE}")
    await cell.report_until(move)
    with pytest.raises(MotionAborted, match="away from the target"):
        await move
    with pytest.raises(NotRearmed):
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


class TestConnecting:
    async def test_nobody_comes(self) -> None:
        with pytest.raises(ConnectTimeout, match="SR500A CMD"):
            await SiasunRobot("main", config(connect_timeout_s=0.05)).connect()

    async def test_disconnect_ends_a_pending_connect(self) -> None:
        settings = config()
        robot = SiasunRobot("main", settings)
        connecting = asyncio.create_task(robot.connect())
        peer = await Peer.greeted(settings.command_port, "CMD")
        await robot.disconnect()
        async with asyncio.timeout(0.5):
            with pytest.raises(LinkLost):
                await connecting
        await peer.close()

    async def test_port_in_use(self) -> None:
        settings = config()
        server = await asyncio.start_server(lambda r, w: None, "127.0.0.1", settings.state_port)
        async with server:
            with pytest.raises(PortInUse):
                await SiasunRobot("main", settings).connect()

    @pytest.mark.parametrize(
        ("changes", "reason"),
        [({"version": "2"}, "VERSION"), ({"eul": "XYZ"}, "CONVENTION"),
         ({"unit": "MRAD"}, "CONVENTION"), ({"robot": "T90A"}, "NAME"),
         ({"deadman": "900"}, "DEADMAN")],
    )  # fmt: skip
    async def test_mismatch(self, changes: dict[str, str], reason: str) -> None:
        settings = config()
        robot = SiasunRobot("main", settings)
        connecting = asyncio.create_task(robot.connect())
        peer = await Peer.connect(settings.command_port)
        assert await peer.hello("CMD", **changes) == f"NO,HELLO,{reason}"
        with pytest.raises(VersionMismatch):
            await connecting
        await peer.closed()
        await peer.close()

    async def test_wrong_channel(self) -> None:
        settings = config()
        connecting = asyncio.create_task(SiasunRobot("main", settings).connect())
        peer = await Peer.connect(settings.command_port)
        assert await peer.hello("STA") == "NO,HELLO,CHANNEL"
        with pytest.raises(VersionMismatch, match="channel STA"):
            await connecting
        await peer.close()

    async def test_a_stranger_does_not_block_the_robot(self) -> None:
        settings = config()
        robot = SiasunRobot("main", settings)
        connecting = asyncio.create_task(robot.connect())
        stranger = await Peer.connect(settings.command_port)
        stranger.writer.write(b"GET / HTTP/1.1\r\n\r\n")
        await stranger.closed()
        await stranger.close()
        cmd = await Peer.greeted(settings.command_port, "CMD")
        sta = await Peer.greeted(settings.state_port, "STA")
        sta.stat()
        await connecting
        await robot.disconnect()
        await cmd.close()
        await sta.close()

    async def test_a_restart_can_listen_again_at_once(self) -> None:
        settings = config()
        for _ in range(2):
            robot = SiasunRobot("main", settings)
            connecting = asyncio.create_task(robot.connect())
            cmd = await Peer.greeted(settings.command_port, "CMD")
            sta = await Peer.greeted(settings.state_port, "STA")
            sta.stat()
            await connecting
            await robot.disconnect()
            await robot.disconnect()
            await cmd.close()
            await sta.close()
