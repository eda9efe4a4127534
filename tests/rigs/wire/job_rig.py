"""The SIASUN driver against the shipped job files, run by the interpreter."""

from collections.abc import AsyncIterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from drivers.robot.siasun.config import SiasunConfig, SiasunStopChannelConfig
from drivers.robot.siasun.driver import SiasunRobot
from fakes.robot_jobs.controller import JobController
from fakes.robot_jobs.program import load_program
from fakes.scenario_file.sections import Channel
from fakes.world.robot import RobotArm
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.proxy import ChaosProxy
from tests.rigs.wire.sjl_rig import arm_settings, connect_both
from tests.rigs.wire.standing_arm import READY_DEG, standing_arm

_REPORT_WORD = 34
"""The string that SJLSTA begins its reports with."""
JOBS = Path(__file__).parents[3] / "drivers" / "robot" / "siasun" / "job"


@dataclass
class JobRig:
    """Driver, controller and the wires between them."""

    robot: SiasunRobot
    controller: JobController
    arm: RobotArm
    wires: dict[Channel, ChaosProxy]
    settings: SiasunConfig
    guard: SiasunStopChannelConfig

    async def connect(self) -> None:
        await connect_both(self.robot, self.controller.start)

    def let_report_overflow(self) -> None:
        """The next report of SJLSTA does not fit into a string: one alarm of many that may end a
        background job."""
        self.controller.memory.strings[_REPORT_WORD] = "X" * 120

    def release_latch(self) -> None:
        """What REARM does to the counts of stops, by somebody else."""
        numbers = self.controller.memory.numbers
        numbers["I", 63], numbers["I", 64] = numbers["I", 61], numbers["I", 62]
        numbers["I", 83] = 0

    def turn(self) -> None:
        """A job begins a motion, with the contact of STA closed as if the daemon were there."""
        self.controller.memory.outputs["DO", 9] = 1
        self.controller._programs["TURN"] = load_program(Path(__file__).parent / "TURN.job")
        self.controller._begin("TURN", background=False)


@asynccontextmanager
async def job_rig(
    *,
    channels: tuple[Channel, ...] = ("CMD", "STA"),
    statement_s: float = 0.0002,
    stands_deg: Sequence[float] = READY_DEG,
    **changes: object,
) -> AsyncIterator[JobRig]:
    """Wired up but neither end started; both are stopped at the end."""
    command_port, state_port, guard_port = free_ports(3)
    settings = arm_settings(command_port, state_port, **changes)
    targets: dict[Channel, int] = {"CMD": command_port, "STA": state_port, "GRD": guard_port}
    async with AsyncExitStack() as stack:
        wires = {
            channel: await stack.enter_async_context(ChaosProxy(targets[channel]))
            for channel in channels
        }
        arm, clock = standing_arm(stands_deg)
        controller = JobController(
            arm,
            clock,
            {channel: wire.port for channel, wire in wires.items()},
            JOBS,
            statement_s=statement_s,
        )
        robot = SiasunRobot("main", settings)
        stack.push_async_callback(controller.stop)
        stack.push_async_callback(robot.disconnect)
        guard = SiasunStopChannelConfig(
            robot_name="SR500A", guard_port=guard_port, connect_timeout_s=3.0
        )
        yield JobRig(robot, controller, arm, wires, settings, guard)
