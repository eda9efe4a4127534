"""Streamed motion by the controller's servo call, one setpoint in each period of this PC.

The controller follows the newest setpoint and stands when there is no other: a tick that is lost is
a standstill, never a jump. It has no ticks of its own that it would report, so this PC counts them,
asks before each setpoint what became of the one before, and starts from the last that took effect.
"""

import asyncio
from collections.abc import Callable
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.robot import (
    NotRearmed,
    SetpointRefused,
    StreamSilent,
    StreamStale,
)
from cellctl.interfaces.streaming_robot import PoseStream, StreamLimits, StreamOffer, StreamReport
from drivers.robot.siasun.bounds import Bounds
from drivers.robot.siasun_rpc import calls
from drivers.robot.siasun_rpc.codec.messages import Request, Value
from drivers.robot.siasun_rpc.config import SiasunRpcConfig
from drivers.robot.siasun_rpc.connections.link import RpcLink
from drivers.robot.siasun_rpc.motion import Motion
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.tick_count import TickCount
from drivers.robot.siasun_rpc.vendor import TaskState
from drivers.robot.siasun_rpc.watch import read_pose


class ServoStream(PoseStream):
    """``begin`` before the first setpoint, ``finish`` after the last one; ``close`` in any case.

    ``on_stale`` is called when setpoints stay away for too long, to stop the arm at once: whoever
    should send them may not be back before long.
    """

    def __init__(
        self,
        robot: str,
        config: SiasunRpcConfig,
        link: RpcLink,
        motion: Motion,
        *,
        bounds: Bounds,
        limits: StreamLimits,
        offer: StreamOffer,
        on_stale: Callable[[CellError], None],
    ) -> None:
        self.period_s = offer.period_s
        self.limits = limits
        self._robot = robot
        self._config = config
        self._link = link
        self._motion = motion
        self._bounds = bounds
        self._on_stale = on_stale
        self._report: StreamReport | None = None
        self._late = self._without_effect = 0
        self._ineffective = 0
        """Setpoints in a row that the controller has not followed."""
        self._sent: RigidTransform | None = None
        """The newest setpoint, as long as it is not known whether it took effect."""
        self._stale: asyncio.TimerHandle | None = None
        self._pose_question = request("get_tcp_pose_coord", config.tool, config.work_frame)

    @property
    def report(self) -> StreamReport:
        """The newest report; there is one as soon as the stream has begun."""
        assert self._report is not None  # ``begin`` has returned
        return self._report

    async def begin(self) -> None:
        """Ask for the pose in which the stream starts. Nothing that moves is sent."""
        asked_s = now_s()
        (pose,) = await self._exchange(self._pose_question)
        here = read_pose(pose, self._config.euler)
        self._ticks = TickCount(self.period_s, asked_s)
        self._start = self._last = self._command = here
        self._report = StreamReport(asked_s, 1, here, late=0, lost=0, sent_s=asked_s)
        self._expect_setpoint()

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        """Wait for the next tick, see what became of the last setpoint, and send this one."""
        self._motion.raise_end()
        self._motion.check_state()
        self._bounds.set_point(base_T_flange, self._last, self._start, self.limits)
        before, self._last = self._last, base_T_flange
        await self._motion.pause(self._ticks.begin_next(now_s()) - now_s())
        self._expect_setpoint()
        asked_s = now_s()
        here = await self._look_back()
        # The bounds have held the target against the one before it; where the arm has followed that
        # one, nothing is left to limit.
        caught_up = self._command is before
        self._sent = base_T_flange if caught_up else self._towards(base_T_flange)
        sent_s = now_s()
        await self._send(self._sent)
        ticks = self._ticks
        self._late += now_s() > ticks.end_s
        lost = ticks.lost + self._without_effect
        self._report = StreamReport(asked_s, ticks.tick, here, self._late, lost, sent_s)
        return self._report

    async def finish(self, timeout_s: float) -> None:
        """Wait until the arm stands at the last setpoint; raises what has ended the stream."""
        self._motion.raise_end()
        self.close()
        if self._sent is None:
            self._motion.over = True
        else:
            await self._motion.finish(timeout_s)

    def close(self) -> None:
        """Expect no more setpoints."""
        if self._stale is not None:
            self._stale.cancel()

    async def _look_back(self) -> RigidTransform:
        """The pose of the flange. Also finds, by the state of its task, whether the last setpoint
        counts."""
        if self._sent is None:
            (pose,) = await self._exchange(self._pose_question)
            return read_pose(pose, self._config.euler)
        state, pose = await self._exchange(
            request("get_noneblock_taskstate", self._motion.task), self._pose_question
        )
        # A setpoint is interrupted by the next one, which is no bad end in a stream.
        followed = state in {TaskState.RUNNING, TaskState.FINISHED, TaskState.INTERRUPTED}
        if followed:
            self._command, self._ineffective = self._sent, 0
        else:
            await self._motion.unless_bad_end(cast(int, state))
            self._without_effect += 1
            self._ineffective += 1
            if self._ineffective * self.period_s > self.limits.loss_s:
                raise StreamStale(f"{self._robot}: follows no setpoint any more")
        return read_pose(pose, self._config.euler)

    async def _send(self, command: RigidTransform) -> None:
        """The servo call, and in one piece with it the question whether the guard has stopped."""
        config = self._config
        report, _ = self._link.watch.newest(config.stale_s)
        call = calls.servo(config, command, report.joints_rad)
        words = [
            request("read_word_reg", number)
            for number in (config.stop_word, config.rearm_word)
            if number is not None
        ]
        self._motion.raise_end()
        self._motion.over = False
        task, *stops = await self._exchange(call, *words)
        if cast(int, task) < 0:
            texts = await self._link.vendor_errors()
            raise SetpointRefused(f"{self._robot}: servoj_pose gave {task}; {' | '.join(texts)}")
        self._motion.task = cast(int, task)
        if stops and stops[0] != stops[1]:
            raise NotRearmed(f"{self._robot}: the guard has stopped the arm")

    async def _exchange(self, *requests: Request) -> list[Value]:
        """Calls on the motion connection; ``StreamSilent`` when they are not answered."""
        replies = asyncio.gather(*self._link.motion.send(*requests))
        await asyncio.wait({replies}, timeout=self.limits.loss_s)
        silent = not replies.done()
        if silent:
            replies.cancel()
        else:
            replies.exception()  # seen, even where the next line has a better explanation
        # A stop or a loss that has come meanwhile: this connection falls with the others.
        self._motion.raise_end()
        if silent:
            raise StreamSilent(f"{self._robot}: no answer within {self.limits.loss_s:g} s")
        return replies.result()

    def _towards(self, target: RigidTransform) -> RigidTransform:
        """From where the arm was last sent with effect towards a setpoint, by at most one step:
        what was lost is not made up for at once."""
        delta = self._command.inv() * target
        turn = delta.rotation.as_rotvec()
        ratio = min(
            1.0,
            self.limits.step_m / max(float(np.linalg.norm(delta.translation)), 1e-12),
            self.limits.step_rad / max(float(np.linalg.norm(turn)), 1e-12),
        )
        if ratio == 1.0:
            return target
        part = RigidTransform.from_components(
            ratio * delta.translation, Rotation.from_rotvec(ratio * turn)
        )
        return self._command * part

    def _expect_setpoint(self) -> None:
        self.close()
        loop = asyncio.get_running_loop()
        self._stale = loop.call_later(self.limits.loss_s + self.period_s, self._no_setpoint)

    def _no_setpoint(self) -> None:
        self._on_stale(StreamStale(f"{self._robot}: no setpoint within {self.limits.loss_s:g} s"))
