"""A stream of setpoints over CMD, and the ticks that the controller answers with."""

import asyncio

from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.link import ProtocolViolation
from cellctl.errors.robot import StreamSilent
from cellctl.interfaces.streaming_robot import PoseStream, StreamLimits, StreamOffer, StreamReport
from drivers.robot.siasun import protocol
from drivers.robot.siasun.bounds import Bounds
from drivers.robot.siasun.channels.running_command import RunningCommand
from drivers.robot.siasun.codec.poses import read_pose, write_pose
from drivers.robot.siasun.codec.records import Six, Tick
from drivers.robot.siasun.connection import SjlChannel


class SiasunStream(PoseStream):
    """``begin`` before the first setpoint, ``finish`` after the last one."""

    def __init__(
        self,
        channel: SjlChannel,
        command: RunningCommand,
        bounds: Bounds,
        limits: StreamLimits,
        offer: StreamOffer,
    ) -> None:
        self.period_s = offer.period_s
        self.limits = limits
        self._channel = channel
        self._command = command
        self._bounds = bounds
        self._set_number = 0
        self._sent_s: float | None = None
        self._report: StreamReport | None = None

    @property
    def report(self) -> StreamReport:
        """The newest report; there is one as soon as the stream has begun."""
        assert self._report is not None  # ``begin`` has returned
        return self._report

    async def begin(self) -> None:
        """Wait for the first tick, whose pose is the start of the stream."""
        report = await self._after(0)
        self._start = self._last = report.base_T_flange

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        """SET for the tick after the newest one, and the TICK that answers it."""
        self._command.raise_end()
        self._bounds.set_point(base_T_flange, self._last, self._start, self.limits)
        # A caller that gave up waiting may be back before the tick of its last setpoint has come.
        await self._after(self._set_number - 1)
        # The newest tick may have come after the report that the caller has seen.
        number = self.report.tick + 1
        xyzabc = write_pose(base_T_flange, self._channel.hello.euler_order)
        self._sent_s = now_s()
        self._channel.send(protocol.set_point(self._command.session, number, xyzabc))
        self._last, self._set_number = base_T_flange, number
        return await self._after(number - 1)

    async def finish(self, timeout_s: float) -> Six:
        """FINISH; the flange's pose at standstill. Raises what has ended the stream before."""
        self._command.raise_end()
        self._channel.send(protocol.finish_stream(self._command.session, self._command.seq))
        return await self._command.done(timeout_s)

    async def _after(self, number: int) -> StreamReport:
        """The newest tick, once there is one after a number."""
        command = self._command
        try:
            # The same time in which the robot ends a stream without setpoints: neither end waits
            # longer for the other.
            async with asyncio.timeout(self.limits.loss_s):
                while command.tick is None or command.tick.number <= number:
                    command.news.clear()
                    command.raise_end()
                    await command.news.wait()
        except TimeoutError:
            raise StreamSilent(
                f"{self._channel}: no tick after {number} within {self.limits.loss_s:g} s"
            ) from None
        command.raise_end()
        self._report = self._reported(command.tick)
        return self._report

    def _reported(self, tick: Tick) -> StreamReport:
        if tick.set_number > self._set_number:
            raise ProtocolViolation(f"{self._channel}: setpoint {tick.set_number} was never sent")
        return StreamReport(
            time_s=self._command.tick_time_s,
            tick=tick.number,
            base_T_flange=read_pose(tick.flange_xyzabc, self._channel.hello.euler_order),
            late=tick.late,
            lost=tick.lost,
            sent_s=self._command.tick_time_s if self._sent_s is None else self._sent_s,
        )
