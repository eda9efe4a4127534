"""Asks the controller for its state again and again, on a connection of its own.

A report is an answer to a question that this PC has just asked, so its age counts from the question
and nothing that is repeated from memory by a network in between can look fresh. What only the state
stream tells (override, error number, simulation) is taken from its newest frame.
"""

import asyncio
import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.link import LinkError, LinkLost, ProtocolViolation, StaleData
from cellctl.geometry.euler import angles_of, rotation_of
from cellctl.geometry.euler_order import EulerOrder
from cellctl.geometry.pose import Array
from cellctl.interfaces.robot import RobotMode, RobotState
from drivers.robot.siasun_rpc.codec.messages import Request, Value
from drivers.robot.siasun_rpc.codec.state_frame import StateFrame
from drivers.robot.siasun_rpc.config import SiasunRpcConfig
from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.connections.frame_stream import FrameStream
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.vendor import OperationMode, Power, SafetyState

SAFE = frozenset({SafetyState.RUN.value, SafetyState.REDUCED.value})
"""States of the safety functions in which the arm may move."""
_MODES = {
    OperationMode.MANUAL.value: RobotMode.MANUAL,
    OperationMode.AUTOMATIC.value: RobotMode.AUTOMATIC,
    OperationMode.REMOTE.value: RobotMode.REMOTE,
}
_FRAME_RAD = 0.5
"""Largest difference of a joint between a frame and an answer. No joint turns so far in the time
between two frames: 225°/s (vendor's manual) for 0.1 s are 0.39 rad."""
_STILL_M = 2e-5
"""Distance between two reports within which an arm stands; its brakes and its control move it
less."""


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One round of answers."""

    time_s: float
    """Monotonic time at which they were asked for."""
    moving: bool
    power: int
    program: int
    safety: int
    mode: int
    pose: Array
    """Shape (6,): the flange in the base in the controller's own numbers, metres and rad."""
    joints_rad: Array
    """Shape (6,)."""
    stop_word: int
    """What the guard has counted its stops to, 0 without a guard."""
    rearm_word: int
    """The count up to which the guard's stops are acknowledged."""

    @property
    def guard_stopped(self) -> bool:
        """The guard has stopped the arm and nobody has acknowledged it."""
        return self.stop_word != self.rearm_word


ROUND_TRIPS = 500
"""How many are remembered: those of the last ten seconds, at 50 questions a second."""


class StateWatch:
    """``run`` asks as long as it is let; everybody else reads what it has heard."""

    def __init__(
        self, robot: str, config: SiasunRpcConfig, connection: RpcConnection, frames: FrameStream
    ) -> None:
        self._robot = robot
        self._config = config
        self._connection = connection
        self._frames = frames
        self._report: Report | None = None
        self._agreed = False
        """A frame has said the same as the answers, so that frames begin where they are looked for.
        """
        self._agreed_s = 0.0
        self._news = asyncio.Event()
        self._requests = _questions(config)
        self.round_trips_s: deque[float] = deque(maxlen=ROUND_TRIPS)
        """From each set of questions to its answers."""

    def follow(self, connection: RpcConnection, frames: FrameStream) -> None:
        """Go on with those of a new session; whoever waits for a report waits for one of it."""
        self._connection, self._frames = connection, frames

    async def run(self) -> None:
        """Ask and remember; drops the connection when the state stream is not to be trusted."""
        self._report = None
        self._agreed, self._agreed_s = False, now_s()
        while True:
            asked_s = now_s()
            replies = await self._connection.exchange(
                *self._requests, timeout_s=self._config.silence_s
            )
            self.round_trips_s.append(now_s() - asked_s)
            try:
                self._report = _report(asked_s, replies)
                self._compare(self._report)
            except LinkError as fault:
                self._connection.drop(fault)
                raise
            # A new event for each report: who waits from now on waits for the next one.
            self._news.set()
            self._news = asyncio.Event()
            await asyncio.sleep(max(0.0, asked_s + self._config.poll_period_s - now_s()))

    def _compare(self, report: Report) -> None:
        """Raise ``LinkLost`` when the state stream is silent, ``ProtocolViolation`` when it says
        something else than the answers for longer than a change may take to reach both."""
        frame, time_s, allowed_s = self._frames.newest, now_s(), self._config.silence_s
        if frame is not None and _agree(frame, report):
            self._agreed, self._agreed_s = True, time_s
        silent_s = time_s - self._frames.time_s
        if silent_s > allowed_s:
            raise LinkLost(f"{self._robot}: no state frame for {silent_s:.2f} s")
        if time_s - self._agreed_s > allowed_s:
            raise ProtocolViolation(
                f"{self._robot}: state stream and answers contradict each other"
            )

    def newest(self, max_age_s: float) -> tuple[Report, StateFrame]:
        """The newest report and frame; ``StaleData`` when the report is older than allowed."""
        report, frame = self._report, self._frames.newest
        age_s = math.inf if report is None else now_s() - report.time_s
        if report is None or frame is None or age_s > max_age_s:
            facts = "none yet" if report is None or frame is None else f"{age_s:.3f} s old"
            raise StaleData(f"state of {self._robot}: {facts}, allowed {max_age_s:g} s")
        return report, frame

    def state(self, max_age_s: float) -> RobotState:
        """The newest report as the cell reads it; ``StaleData`` as ``newest``."""
        report, frame = self.newest(max_age_s)
        words = self._config.error_words(frame.error)
        return robot_state(report, frame, self._config.euler, words)

    async def wait(self, condition: Callable[[Report], bool], timeout_s: float) -> None:
        """Wait for a report asked for from now on that meets a condition; else ``StaleData``."""
        since_s = now_s()
        try:
            async with asyncio.timeout(timeout_s):
                while not (
                    self._report and self._report.time_s >= since_s and condition(self._report)
                ):
                    await self._news.wait()
        except TimeoutError:
            facts = f"{self._robot} did not report the expected state within {timeout_s:g} s"
            raise StaleData(facts) from None

    async def stands(self, timeout_s: float) -> None:
        """Wait for two reports in a row of an arm that does not move and is in the same place;
        else ``StaleData``. One is not enough: a motion may be about to begin."""
        last: Report | None = None

        def settled(report: Report) -> bool:
            nonlocal last
            before, last = last, report
            if before is None or before.moving or report.moving:
                return False
            return float(np.linalg.norm(before.pose[:3] - report.pose[:3])) <= _STILL_M

        await self.wait(settled, timeout_s)

    async def until_first(self, timeout_s: float) -> None:
        """Wait for the first report and a frame that agrees with it; else ``StaleData``."""
        await self.wait(lambda _: self._agreed, timeout_s)


def robot_state(
    report: Report, frame: StateFrame, euler: EulerOrder, error_words: str
) -> RobotState:
    """A report and a frame in the words of the interface.

    Every state of the safety functions in which the arm may not move counts as emergency stop. A
    mode that this driver does not know counts as manual, in which nothing moves.
    """
    return RobotState(
        time_s=report.time_s,
        base_T_flange=_transform(report.pose, euler),
        joints_rad=report.joints_rad,
        mode=_MODES.get(report.mode, RobotMode.MANUAL),
        emergency_stop=report.safety not in SAFE,
        drives_on=report.power == Power.ENABLED,
        moving=report.moving,
        stop_latched=report.guard_stopped,
        error_code=frame.error,
        error_words=error_words,
        speed_override_ratio=frame.override_percent / 100.0,
    )


def _questions(config: SiasunRpcConfig) -> list[Request]:
    questions = [
        # Before the pose, so that the pose of an arm that stands is the one where it stands.
        request("robotmoving"),
        request("get_robot_state"),
        request("get_tcp_pose_coord", config.tool, config.work_frame),
        request("get_actual_joints_position"),
    ]
    if config.stop_word is not None and config.rearm_word is not None:
        questions += [
            request("read_word_reg", config.stop_word),
            request("read_word_reg", config.rearm_word),
        ]
    return questions


def _report(asked_s: float, replies: list[Value]) -> Report:
    moving, states, pose, joints, *words = replies
    flags = cast(list[int], states)
    if len(flags) != 4:
        raise ProtocolViolation(f"{len(flags)} states where 4 were expected")
    stop_word, rearm_word = cast(list[int], words) or [0, 0]
    return Report(
        time_s=asked_s,
        moving=bool(moving),
        power=flags[0],
        program=flags[1],
        safety=flags[2],
        mode=flags[3],
        pose=_six(pose),
        joints_rad=_six(joints),
        stop_word=stop_word,
        rearm_word=rearm_word,
    )


def read_pose(value: Value, euler: EulerOrder) -> RigidTransform:
    """A pose of a reply: metres, and radians in the controller's order; ``ProtocolViolation`` if
    it is none."""
    return _transform(_six(value), euler)


def write_pose(pose: RigidTransform, euler: EulerOrder) -> list[float]:
    """A pose as a call takes it: metres, and radians in the controller's order."""
    return [*pose.translation.tolist(), *angles_of(euler, pose.rotation).tolist()]


def _agree(frame: StateFrame, report: Report) -> bool:
    states = (frame.mode, frame.power, frame.safety) == (report.mode, report.power, report.safety)
    return states and bool(np.all(np.abs(report.joints_rad - frame.joints_rad) <= _FRAME_RAD))


def _transform(numbers: Array, euler: EulerOrder) -> RigidTransform:
    return RigidTransform.from_components(numbers[:3], rotation_of(euler, numbers[3:]))


def _six(value: Value) -> Array:
    numbers = np.asarray(value, dtype=float)
    if numbers.shape != (6,) or not np.isfinite(numbers).all():
        raise ProtocolViolation(f"six finite numbers expected, got {value!r:.120}")
    return numbers
