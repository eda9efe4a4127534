"""A connected SIASUN driver and the scripted ends of its channels."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

from cellctl.geometry.pose import pose_from_xyzabc
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.driver import SiasunRobot
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.siasun_peer import POSE, Peer

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
        "joints_min_deg": (-360.0,) * 6,
        "joints_max_deg": (360.0,) * 6,
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
async def running(
    *, option: str = "", euler: str = "ZYX", pose: str = POSE, **changes: object
) -> AsyncIterator[Cell]:
    """``option`` is one that the controller's CMD channel offers in its hello, ``euler`` the order
    of angles that both name; ``pose`` is the first one that is reported."""
    settings = config(**changes)
    robot = SiasunRobot("main", settings)
    connecting = asyncio.create_task(robot.connect())
    cmd = await Peer.greeted(settings.command_port, "CMD", option, eul=euler)
    sta = await Peer.greeted(settings.state_port, "STA", eul=euler)
    sta.stat(pose=pose)
    await connecting
    cell = Cell(robot, cmd, sta)
    try:
        yield cell
    finally:
        await robot.disconnect()
        await cell.cmd.close()
        await cell.sta.close()
