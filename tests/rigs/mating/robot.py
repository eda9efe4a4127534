"""The main robot without sockets: the fake controller's own logic behind the Robot interface."""

import asyncio

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.link import LinkLost, StaleData
from cellctl.errors.robot import MotionAborted, MotionRejected, NotRearmed, StopFailed
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.interfaces import Robot, RobotMode, RobotState
from fakes.scenario_file.sections import Channel
from fakes.wire.sjl.logic import Controller, Record

SESSION = 1
REPORT_S = 0.02
POLL_S = 0.005
MOVE_TIMEOUT_S = 120.0
CHANNELS: tuple[Channel, ...] = ("CMD", "STA", "GRD")


class WorldRobot(Robot):
    """Speaks the records of SJL/1 to the controller in place; reports every 20 ms."""

    name = "main"

    def __init__(self, controller: Controller, start_s: float) -> None:
        self._controller = controller
        self._seq = 0
        self._answers: dict[int, Record] = {}
        self._stops = self._confirmed = 0
        self._state: RobotState | None = None
        self._down = False
        self._latch = False
        for channel in CHANNELS:
            controller.opened(channel, SESSION, start_s)

    def tick(self, time_s: float, *, guard_beats: bool) -> None:
        """Heartbeats out, answers and reports in; once a simulated millisecond."""
        for channel, link in self._controller.links.items():
            if guard_beats or channel != "GRD":
                link.beat_s = time_s
        for channel, record in self._controller.tick(time_s):
            if channel == "CMD":
                self._answers[int(record[1])] = record
            elif record[0] == "STOPD" and channel == "STA":
                self._confirmed = int(record[1])
        if self._state is None or time_s >= self._state.time_s + REPORT_S:
            self._state = self._report(time_s)

    @property
    def reported(self) -> RigidTransform:
        """The flange pose that the guard's channel last saw."""
        assert self._state is not None
        return self._state.base_T_flange

    def lose_link(self, time_s: float) -> None:
        """Both channels of the daemon break; the controller stops by itself."""
        self._down = True
        self._controller.closed("CMD", time_s)
        self._controller.closed("STA", time_s)

    async def connect(self) -> None:
        """Nothing to connect."""

    async def disconnect(self) -> None:
        """Nothing to drop."""

    def state(self, max_age_s: float = 0.25) -> RobotState:
        self._check_link()
        state = self._state
        assert state is not None
        if asyncio.get_running_loop().time() - state.time_s > max_age_s:
            raise StaleData("main: no report")
        return state

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        degrees = [f"{value:.5f}" for value in np.rad2deg(joints_rad)]
        return await self._move(["MOVJ", *degrees, str(round(100 * speed_ratio))])

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        rates = [f"{speed_m_s / MM:.4f}", f"{acceleration_m_s2 / MM:.4f}"]
        return await self._move(["MOVL", *_written(base_T_flange), *rates])

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        return await self._move(["STEP", *_written(base_T_flange), f"{speed_m_s / MM:.4f}"])

    async def stop(self) -> None:
        self._check_link()
        self._latch = True
        loop = asyncio.get_running_loop()
        self._stops += 1
        record = ["ABORT", str(SESSION), str(self._stops)]
        self._controller.supervise("STA", record, loop.time())
        give_up_s = loop.time() + 2.0
        while self._confirmed < self._stops:
            if loop.time() > give_up_s:
                raise StopFailed("no standstill")
            await asyncio.sleep(POLL_S)

    async def rearm(self) -> None:
        self._check_link()
        self._latch = False
        await self._run(["REARM"])

    async def _move(self, fields: Record) -> RobotState:
        self._check_link()
        if self._latch or self._controller.latched:
            raise NotRearmed("latched")
        try:
            return await self._run(fields)
        except MotionAborted:
            self._latch = True
            raise
        except asyncio.CancelledError:
            if not self._down:
                await self.stop()
            raise

    async def _run(self, fields: Record) -> RobotState:
        loop = asyncio.get_running_loop()
        self._seq += 1
        seq = self._seq
        record = [fields[0], str(SESSION), str(seq), *fields[1:]]
        for _, answer in self._controller.command(record, loop.time()):
            if answer[0] == "REJ":
                raise MotionRejected(answer[2])
            self._answers[seq] = answer
        give_up_s = loop.time() + MOVE_TIMEOUT_S
        while self._answers.get(seq, ["ACK"])[0] == "ACK":
            self._check_link()
            if loop.time() > give_up_s:
                raise MotionAborted("no end of motion")
            await asyncio.sleep(POLL_S)
        answer = self._answers.pop(seq)
        if answer[0] == "ABRT":
            raise MotionAborted(answer[2])
        await asyncio.sleep(REPORT_S)
        return self._report(loop.time())

    def _report(self, time_s: float) -> RobotState:
        arm = self._controller.arm
        return RobotState(
            time_s=time_s,
            base_T_flange=arm.encoder_pose(time_s),
            joints_rad=arm.joints(time_s),
            mode=RobotMode.REMOTE,
            emergency_stop=False,
            drives_on=True,
            moving=arm.moving(time_s),
            stop_latched=self._latch or self._controller.latched,
            error_code=0,
            speed_override_ratio=1.0,
        )

    def _check_link(self) -> None:
        if self._down:
            raise LinkLost("main: CMD and STA are gone")


def _written(base_T_flange: RigidTransform) -> list[str]:
    return [f"{value:.4f}" for value in pose_to_xyzabc(base_T_flange)]
