"""A SIASUN collaborative arm over its remote interface (docs/protocols/siasun-rpc.md)."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, LinkLost, VersionMismatch
from cellctl.errors.robot import (
    MotionAborted,
    MotionRejected,
    NotRearmed,
    SetpointRefused,
    StopFailed,
    StreamSilent,
    TargetOutOfBounds,
)
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.arm_load import PendantSelection
from cellctl.interfaces.robot import RobotState
from cellctl.interfaces.streaming_robot import (
    PoseStream,
    StreamingRobot,
    StreamLimits,
    StreamOffer,
)
from drivers.robot.siasun.bounds import Bounds
from drivers.robot.siasun.channels.latched import latched
from drivers.robot.siasun.codec.records import StreamFigures, StreamOption
from drivers.robot.siasun.described_arm import DescribedArm
from drivers.robot.siasun.followed_stream import followed
from drivers.robot.siasun.targets import MotionTarget, Targets
from drivers.robot.siasun_rpc import calls
from drivers.robot.siasun_rpc.codec.messages import Request
from drivers.robot.siasun_rpc.config import SiasunRpcConfig
from drivers.robot.siasun_rpc.connections.background import BackgroundTasks
from drivers.robot.siasun_rpc.connections.link import RpcLink
from drivers.robot.siasun_rpc.motion import Motion
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.readiness import check_ready
from drivers.robot.siasun_rpc.selection import MOST_LOAD_KG, selection
from drivers.robot.siasun_rpc.stream import ServoStream


class SiasunRpcRobot(DescribedArm, StreamingRobot):
    """Calls that return at once, and questions about the task that they have begun.

    The controller has no latch of its own: after a stop it would obey the next call. The latch is
    therefore in this driver, and beside a guard in two word registers of the controller. Mode,
    power, enable and override are shown and never changed from here.
    """

    Config = SiasunRpcConfig
    most_load_kg = MOST_LOAD_KG

    def __init__(self, name: str, config: SiasunRpcConfig) -> None:
        self.name = name
        self._config = config
        self._bounds = Bounds(name, config)
        self._targets = Targets(self._bounds, config)
        self._latch: CellError | None = None
        """Why moves are refused until ``rearm``."""
        self._motion: Motion | None = None
        self._link = RpcLink(name, config, self._on_lost)
        self._connecting = asyncio.Lock()
        self._background = BackgroundTasks()

    @classmethod
    def check_joint_target(cls, config: Any, joints_rad: Array) -> None:
        """Limits of the joints, and with a dh table the box of the flange in joint moves."""
        Bounds(config.host, config).joint_target(joints_rad)

    async def connect(self) -> None:
        """Wait for a first state; ``VersionMismatch`` when by a dh table joints and pose differ."""
        async with self._connecting:
            await self._link.open()
            # An order of angles that is wrong is wrong in both directions: every pose comes back as
            # it was sent, and only the kinematics tell.
            try:
                self._bounds.table_fits(self._link.watch.state(self._config.stale_s))
            except TargetOutOfBounds as misfit:
                self._close()
                raise VersionMismatch(misfit.detail) from misfit

    async def disconnect(self) -> None:
        """Stop a running motion and close all connections."""
        try:
            if self._motion is not None and self._link.up:
                await self.stop()
        finally:
            self._close()

    def state(self, max_age_s: float = 0.25) -> RobotState:
        """The newest report. ``stop_latched`` includes this driver's own latch."""
        self._check_link()
        state = self._link.watch.state(max_age_s)
        return latched(state, self._latch, "", running=self._motion is not None)

    def link_facts(self) -> dict[str, str]:
        """Version, and the frames that every pose is asked for with."""
        return self._link.facts()

    def round_trips_s(self) -> tuple[float, ...]:
        """Round trips of the questions for the arm's state, which are asked all the time."""
        return tuple(self._link.watch.round_trips_s)

    async def selection(self) -> PendantSelection:
        """Poses do not depend on it: each is asked for and sent with the frames of the settings."""
        self._check_link()
        return await selection(self._link, self._config.euler)

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """movej. With a dh table, refused when the flange would leave its box on the way."""
        _, percent = self._bounds.joints(joints_rad, speed_ratio)
        call = calls.move_joint(self._config, np.asarray(joints_rad, dtype=float), percent)
        return await self._move(call, self._targets.joints(joints_rad))

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """movel, ends at standstill. With a dh table, refused when the arm cannot follow it."""
        self._bounds.pose(base_T_flange)
        speed_m_s = self._bounds.speed_mm_s(speed_m_s) * MM
        acceleration_m_s2 = self._bounds.acceleration_mm_s2(acceleration_m_s2) * MM
        return await self._move_linear(base_T_flange, speed_m_s, acceleration_m_s2)

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """A short movel. The controller knows no limit of a step; the configuration's counts."""
        self._bounds.pose(base_T_flange)
        speed_m_s = self._bounds.speed_mm_s(speed_m_s) * MM
        state = self.state(self._config.stale_s)
        self._bounds.step(state, base_T_flange, self._config.max_step_mm)
        return await self._move_linear(
            base_T_flange, speed_m_s, self._config.max_acceleration_mm_s2 * MM
        )

    def stream_offer(self) -> StreamOffer:
        """What the configuration allows, if it has a measured period and the version can stream."""
        self._check_link()
        config, features = self._config, self._link.features
        if config.servo_period_ms is None or not features.streams:
            raise features.not_offered(self.name, config.servo_period_ms)
        figures = StreamFigures(
            config.max_stream_step_mm,
            config.max_stream_step_deg,
            config.max_stream_travel_mm,
            config.max_stream_travel_deg,
            round(config.max_stream_loss_s * 1000.0),
        )
        return self._bounds.stream_offer(StreamOption(config.servo_period_ms, figures))

    @asynccontextmanager
    async def stream(self, limits: StreamLimits) -> AsyncIterator[PoseStream]:
        """Servo calls from the present pose on; stops the arm when it is left early."""
        offer = self.stream_offer()
        self._bounds.stream(limits, offer)
        self._check_ready()
        with self._claim() as motion:
            stream = ServoStream(
                self.name,
                self._config,
                self._link,
                motion,
                bounds=self._bounds,
                limits=limits,
                offer=offer,
                on_stale=lambda fault: self._stop_in_background(motion, fault),
            )
            try:
                await motion.check_guard()
                motion.over = False
                end_s = self._config.stop_timeout_s
                async with followed(stream, end_s, not_taken=SetpointRefused):
                    yield stream
            except BaseException as error:
                stream.close()
                await self._leave(error, motion)
                if isinstance(error, StreamSilent):
                    await self._link.renew_motion()
                raise

    async def stop(self) -> None:
        """stop, repeated until the arm is reported to stand. Without that all connections are
        closed until ``connect``: no heartbeat, so that the controller stops the arm by itself."""
        # Before anything is sent or awaited, so that no move can begin while the stop is under way.
        self._latch = NotRearmed(f"{self.name}: a stop was requested")
        if self._motion is not None:
            self._motion.end(MotionAborted(f"{self.name}: stop was requested"))
        try:
            async with asyncio.timeout(self._config.stop_timeout_s):
                await self._link.stop_until_standing()
        except (TimeoutError, LinkError) as error:
            late = "it has not answered a move" if self._link.owes_move else "no standstill"
            words = error.detail if isinstance(error, LinkError) else late
            self._latch = StopFailed(f"{self.name}: {words} in {self._config.stop_timeout_s:g} s")
            self._close()
            raise self._latch from error

    async def rearm(self) -> None:
        """Acknowledge the guard's stops that are known, and release this driver's latch."""
        if self._motion is not None:
            raise MotionRejected(f"{self.name}: cannot rearm while a motion runs")
        self._check_link()
        # Remembered, so that a stop that comes during the release is not released with it.
        latch, timeout_s = self._latch, self._config.reply_timeout_s
        await self._link.lapsed()
        await self._link.watch.stands(self._config.stop_timeout_s)
        report, _ = self._link.watch.newest(self._config.stale_s)
        if report.guard_stopped:
            assert self._config.rearm_word is not None  # or there would be no count
            acknowledge = request("write_word_reg", self._config.rearm_word, report.stop_word)
            await self._link.control.exchange(acknowledge, timeout_s=timeout_s)
            await self._link.watch.wait(lambda now: not now.guard_stopped, timeout_s)
        if self._latch is not latch:
            raise NotRearmed(f"{self.name}: {self._latch}, while it was re-armed")
        self._latch = None

    async def _move_linear(
        self, base_T_flange: RigidTransform, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        state = self.state(self._config.stale_s)
        call = calls.move_linear(
            self._config,
            base_T_flange,
            state.joints_rad,
            speed_m_s=speed_m_s,
            acceleration_m_s2=acceleration_m_s2,
        )
        return await self._move(call, self._targets.flange(base_T_flange))

    async def _move(self, call: Request, target: MotionTarget) -> RobotState:
        """Run one motion to standstill; leave it early only after stopping the robot."""
        self._check_ready()
        target.check_way(self.state(self._config.stale_s))
        with self._claim() as motion:
            try:
                await motion.begin(call)
                await motion.finish(self._config.move_timeout_s)
            except BaseException as error:
                await self._leave(error, motion)
                raise
        end = self.state(self._config.stale_s)
        # A controller that says "finished" elsewhere has another idea of the target, such as
        # another Euler order; the next move would be wrong as well.
        if off := target.off(end):
            self._latch = MotionAborted(f"{self.name} reports its end {off} away from the target")
            raise self._latch
        return end

    @contextmanager
    def _claim(self) -> Iterator[Motion]:
        """The one motion at a time, inside the context."""
        self._motion = Motion(self.name, self._config, self._link)
        try:
            yield self._motion
        finally:
            self._motion = None

    async def _leave(self, error: BaseException, motion: Motion) -> None:
        """Stop the robot unless the controller has said itself that nothing moves any more."""
        if isinstance(error, MotionRejected) and motion.over:
            return
        self._latch = self._latch or NotRearmed(f"{self.name}: a motion ended early")
        # Without a link there is nobody to tell; missing heartbeats stop the arm then. Shielded,
        # because a caller that is cancelled once more may give up waiting, but not the stop.
        if not motion.over and self._link.up:
            await asyncio.shield(asyncio.ensure_future(self.stop()))

    def _stop_in_background(self, motion: Motion, fault: CellError) -> None:
        motion.end(fault)
        self._background.start(self.stop())

    def _check_ready(self) -> None:
        if self._motion is not None:
            raise MotionRejected(f"{self.name}: another motion is running")
        self._check_link()
        if self._latch is not None:
            raise NotRearmed(f"{self.name}: {self._latch}") from self._latch
        report, frame = self._link.watch.newest(self._config.stale_s)
        check_ready(self.name, report, frame, self._config.error_words(frame.error))
        self._bounds.table_fits(self._link.watch.state(self._config.stale_s))

    def _check_link(self) -> None:
        if not self._link.up:
            raise LinkLost(f"{self.name} is not connected")

    def _close(self) -> None:
        self._background.cancel()
        if self._motion is not None:
            self._motion.end(LinkLost(f"{self.name} was disconnected"))
        self._link.close()

    def _on_lost(self, fault: LinkError) -> None:
        self._latch = fault
        if self._motion is not None:
            self._motion.end(fault)
