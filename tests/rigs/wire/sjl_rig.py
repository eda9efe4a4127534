"""The SIASUN driver and the fake controller on free ports, with a chaos proxy on each channel."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass

from drivers.robot.siasun.config import SiasunConfig, SiasunStopChannelConfig
from drivers.robot.siasun.driver import SiasunRobot
from fakes.scenario_file.sections import Channel
from fakes.wire.sjl.controller import SjlController
from fakes.wire.sjl.stream import StreamOffer
from fakes.world.robot import RobotArm
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.proxy import ChaosProxy
from tests.rigs.wire.standing_arm import READY_DEG, standing_arm

OFFER = StreamOffer()


def arm_settings(command_port: int, state_port: int, **changes: object) -> SiasunConfig:
    """Settings of the driver of this arm, with changes."""
    return SiasunConfig.model_validate(
        {
            "robot_name": "SR500A",
            "command_port": command_port,
            "state_port": state_port,
            "connect_timeout_s": 3.0,
            "workspace_min_mm": (900.0, -900.0, 300.0),
            "workspace_max_mm": (2500.0, 900.0, 2200.0),
            "joints_min_deg": (-360.0,) * 6,
            "joints_max_deg": (360.0,) * 6,
            "max_speed_mm_s": 250.0,
            "max_joint_speed_percent": 100,
        }
        | changes
    )


@dataclass
class Rig:
    """Driver, controller and the wires between them."""

    robot: SiasunRobot
    controller: SjlController
    arm: RobotArm
    wires: dict[Channel, ChaosProxy]
    settings: SiasunConfig
    guard: SiasunStopChannelConfig

    async def connect(self) -> None:
        await connect_both(self.robot, self.controller.start)

    def release_latch(self) -> None:
        """What REARM does, by somebody else."""
        self.controller.logic.latched = False


async def connect_both(robot: SiasunRobot, start_controller: Callable[[], object]) -> None:
    """Start the controller as soon as the driver listens, which saves it a retry."""
    connecting = asyncio.create_task(robot.connect())
    async with asyncio.timeout(2.0):
        while robot._state.channel._server is None:  # noqa: ASYNC110  no event for it
            await asyncio.sleep(0)
    start_controller()
    await connecting


@asynccontextmanager
async def sjl_rig(
    *,
    channels: tuple[Channel, ...] = ("CMD", "STA"),
    offer: StreamOffer | None = OFFER,
    stands_deg: Sequence[float] = READY_DEG,
    **changes: object,
) -> AsyncIterator[Rig]:
    """Wired up but neither end started; both are stopped at the end. ``offer`` is what the job
    program offers for streamed motion."""
    command_port, state_port, guard_port = free_ports(3)
    settings = arm_settings(command_port, state_port, **changes)
    targets: dict[Channel, int] = {"CMD": command_port, "STA": state_port, "GRD": guard_port}
    async with AsyncExitStack() as stack:
        wires = {
            channel: await stack.enter_async_context(ChaosProxy(targets[channel]))
            for channel in channels
        }
        arm, clock = standing_arm(stands_deg)
        controller = SjlController(
            arm,
            clock,
            {channel: wire.port for channel, wire in wires.items()},
            offer=offer,
        )
        robot = SiasunRobot("main", settings)
        stack.push_async_callback(controller.stop)
        stack.push_async_callback(robot.disconnect)
        guard = SiasunStopChannelConfig(
            robot_name="SR500A", guard_port=guard_port, connect_timeout_s=3.0
        )
        yield Rig(robot, controller, arm, wires, settings, guard)
