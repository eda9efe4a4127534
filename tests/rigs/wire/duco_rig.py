"""The driver of a collaborative arm and its fake controller, with a chaos proxy on both ports."""

from collections.abc import AsyncIterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass

from drivers.robot.siasun_rpc.config import SiasunRpcConfig, SiasunRpcStopChannelConfig
from drivers.robot.siasun_rpc.driver import SiasunRpcRobot
from fakes.wire.duco.controller import DucoController
from fakes.wire.duco.logic import DucoLogic
from fakes.world.robot import RobotArm
from tests.rigs.wire.proxy import ChaosProxy
from tests.rigs.wire.standing_arm import READY_DEG, standing_arm

CONTROLLER = {"tool": "flange", "work_frame": "base", "euler": "fixed-xyz", "stop_word": 1}
CONTROLLER |= {"rearm_word": 2, "heartbeat_ms": 300, "host": "127.0.0.1"}


@dataclass
class DucoRig:
    """Driver, controller and the wires between them."""

    robot: SiasunRpcRobot
    controller: DucoController
    arm: RobotArm
    rpc: ChaosProxy
    frames: ChaosProxy
    settings: SiasunRpcConfig
    guard: SiasunRpcStopChannelConfig

    @property
    def logic(self) -> DucoLogic:
        """What the controller does."""
        return self.controller.logic

    def reset(self) -> None:
        """Cut all wires."""
        self.rpc.reset()
        self.frames.reset()


@asynccontextmanager
async def duco_rig(
    stands_deg: Sequence[float] = READY_DEG, **changes: object
) -> AsyncIterator[DucoRig]:
    """The controller listens, the driver is not connected; both are stopped at the end."""
    arm, clock = standing_arm(stands_deg)
    controller = DucoController(DucoLogic(arm, clock))
    async with AsyncExitStack() as stack:
        await controller.start()
        stack.push_async_callback(controller.stop)
        rpc = await stack.enter_async_context(ChaosProxy(controller.rpc_port))
        frames = await stack.enter_async_context(ChaosProxy(controller.state_port))
        settings = SiasunRpcConfig.model_validate(
            CONTROLLER
            | {
                "rpc_port": rpc.port,
                "state_port": frames.port,
                "workspace_min_mm": (900.0, -900.0, 300.0),
                "workspace_max_mm": (2500.0, 900.0, 2200.0),
                "joints_min_deg": (-360.0,) * 6,
                "joints_max_deg": (360.0,) * 6,
                "max_speed_mm_s": 250.0,
                "max_joint_speed_percent": 100,
                "servo_period_ms": 20,
            }
            | changes
        )
        robot = SiasunRpcRobot("main", settings)
        stack.push_async_callback(robot.disconnect)
        guard = SiasunRpcStopChannelConfig.model_validate(CONTROLLER | {"rpc_port": rpc.port})
        yield DucoRig(robot, controller, arm, rpc, frames, settings, guard)
