"""A robot in memory that follows a stream: the shortest honest implementation of the interface."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import fields

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkLost
from cellctl.errors.robot import (
    MotionAborted,
    MotionRejected,
    NotRearmed,
    StreamSilent,
    StreamStale,
    TargetOutOfBounds,
)
from cellctl.interfaces.streaming_robot import (
    PoseStream,
    StreamingRobot,
    StreamLimits,
    StreamOffer,
    StreamReport,
)
from tests.contracts.inprocess.robot import InProcessRobot

PERIOD_S = 0.008
OFFER = StreamOffer(PERIOD_S, StreamLimits(1e-4, 1e-3, 0.03, 0.08, 0.2))


class InProcessStreamingRobot(InProcessRobot, StreamingRobot):
    """Its arm is at a setpoint as soon as the setpoint is taken."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.losses = 0
        self.late = 0
        self.silent = False
        self._stream: InProcessStream | None = None

    def stream_offer(self) -> StreamOffer:
        self.state()
        return OFFER

    @asynccontextmanager
    async def stream(self, limits: StreamLimits) -> AsyncIterator[PoseStream]:
        offer = self.stream_offer().limits
        for field in fields(StreamLimits):
            if not 0.0 < getattr(limits, field.name) <= getattr(offer, field.name):
                raise TargetOutOfBounds(field.name)
        if self._stream is not None or self.moving:
            raise MotionRejected("busy")
        if self._latched:
            raise NotRearmed("latched")
        stream = self._stream = InProcessStream(self, limits)
        try:
            yield stream
            stream.check()
        except BaseException:
            self._latched = True
            raise
        finally:
            self._stream = None
            await stream.close()

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float):  # type: ignore[no-untyped-def]
        if self._stream is not None:
            raise MotionRejected("busy")
        return await super().step(base_T_flange, speed_m_s=speed_m_s)

    async def stop(self) -> None:
        await super().stop()
        if self._stream is not None:
            self._stream.end(MotionAborted("stop"))

    def _halt(self, reason: CellError) -> None:
        super()._halt(reason)
        if self._stream is not None:
            self._latched = True
            self._stream.end(reason if isinstance(reason, LinkLost) else MotionAborted("stop"))


class InProcessStream(PoseStream):
    """Ticks by a task of its own."""

    def __init__(self, robot: InProcessStreamingRobot, limits: StreamLimits) -> None:
        self.period_s, self.limits = PERIOD_S, limits
        self._robot = robot
        self._start = self._last = robot.flange
        self._setpoint: RigidTransform | None = None
        self._sent_s: float | None = None
        self._tick, self._lost, self._silent_ticks = 1, 0, 0
        self._end: CellError | None = None
        self._news = asyncio.Event()
        self._ticking = asyncio.create_task(self._run())

    @property
    def report(self) -> StreamReport:
        flange, late = self._robot.flange, self._robot.late
        here_s = now_s()
        sent_s = here_s if self._sent_s is None else self._sent_s
        return StreamReport(here_s, self._tick, flange, late, self._lost, sent_s)

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        self.check()
        self._near(base_T_flange, self._last, self.limits.step_m, self.limits.step_rad)
        self._near(base_T_flange, self._start, self.limits.travel_m, self.limits.travel_rad)
        self._last, self._sent_s = base_T_flange, now_s()
        if self._robot.losses:
            self._robot.losses -= 1
        else:
            self._setpoint = base_T_flange
        self._news.clear()
        try:
            async with asyncio.timeout(self.limits.loss_s):
                await self._news.wait()
        except TimeoutError:
            raise StreamSilent("no tick") from None
        self.check()
        return self.report

    def end(self, fault: CellError) -> None:
        self._end = self._end or fault
        self._ticking.cancel()
        self._news.set()

    def check(self) -> None:
        if self._end is not None:
            raise self._end

    async def close(self) -> None:
        self._ticking.cancel()
        await asyncio.gather(self._ticking, return_exceptions=True)

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(PERIOD_S)
            self._tick += 1
            target, self._setpoint = self._setpoint, None
            self._silent_ticks = 0 if target is not None else self._silent_ticks + 1
            self._lost += target is None
            if self._silent_ticks * PERIOD_S > self.limits.loss_s:
                self._robot._latched = True
                self.end(StreamStale("no setpoint"))
            elif target is not None:
                self._robot.flange = self._stepped(target)
            if not self._robot.silent:
                self._news.set()

    def _stepped(self, target: RigidTransform) -> RigidTransform:
        way = self._robot.flange.inv() * target
        length_m = float(np.linalg.norm(way.translation))
        ratio = min(1.0, self.limits.step_m / max(length_m, 1e-12))
        return self._robot.flange * RigidTransform.from_exp_coords(way.as_exp_coords() * ratio)

    def _near(self, target: RigidTransform, other: RigidTransform, m: float, rad: float) -> None:
        if not np.isfinite(target.as_matrix()).all():
            raise TargetOutOfBounds("stream")
        delta = other.inv() * target
        way_m = np.linalg.norm(delta.translation)
        if not (way_m <= m + 1e-9 and delta.rotation.magnitude() <= rad + 1e-9):
            raise TargetOutOfBounds("stream")
