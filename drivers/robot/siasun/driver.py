"""A SIASUN robot whose job programs speak SJL/1 (docs/protocols/sjl-1.md)."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, LinkLost, ReplyTimeout, VersionMismatch
from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    StopFailed,
    StreamNotOffered,
    TargetOutOfBounds,
)
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.robot import RobotState
from cellctl.interfaces.streaming_robot import PoseStream, StreamingRobot, StreamLimits, StreamOffer
from drivers.robot.siasun import faults, protocol
from drivers.robot.siasun.bounds import Bounds
from drivers.robot.siasun.channels.channel_pair import ChannelPair
from drivers.robot.siasun.channels.latched import latched
from drivers.robot.siasun.channels.running_command import RunningCommand
from drivers.robot.siasun.channels.stream import SiasunStream
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.described_arm import DescribedArm
from drivers.robot.siasun.followed_stream import followed
from drivers.robot.siasun.link_facts import link_facts
from drivers.robot.siasun.targets import MotionTarget, Targets


class SiasunRobot(DescribedArm, StreamingRobot):
    """Commands go over CMD; state, heartbeat and stop over STA. The PC listens on both.

    Any fault that leaves it open what the arm does (lost link, invalid record, missing answer,
    stop, abort) sets a latch here too: moves raise ``NotRearmed`` until ``rearm``.
    """

    Config = SiasunConfig

    def __init__(self, name: str, config: SiasunConfig) -> None:
        self.name = name
        self._config = config
        self._bounds = Bounds(name, config)
        self._targets = Targets(self._bounds, config)
        self._latch: CellError | None = None
        """Why moves are refused until ``rearm``."""
        self._channels = ChannelPair(
            name,
            config,
            on_command_lost=self._on_command_lost,
            on_stopped=self._on_stopped,
            on_state_lost=self._on_state_lost,
        )
        self._command, self._state = self._channels.command, self._channels.state
        self._connecting = asyncio.Lock()
        self._connected = False

    @classmethod
    def needs_permit(cls, config: Any) -> bool:  # noqa: ARG003
        """Always: dead man and stop are job programs, and an alarm of one ends it."""
        return True

    @classmethod
    def check_joint_target(cls, config: Any, joints_rad: Array) -> None:
        """Limits of the joints, and with a dh table the box of the flange in joint moves."""
        Bounds(config.robot_name, config).joint_target(joints_rad)

    async def connect(self) -> None:
        """Listen and wait for both channels and a first state report; with a dh table,
        ``VersionMismatch`` when the pose does not fit the joints. Idempotent."""
        async with self._connecting:
            if not self._connected:
                await self._connect()
                self._connected = True

    async def _connect(self) -> None:
        try:
            await self._channels.open()
            self._bounds.table_fits(self._state.newest(self._config.stale_s))
        except TargetOutOfBounds as misfit:
            await self._close()
            raise VersionMismatch(misfit.detail) from misfit
        # Also after a cancellation: a port that stays open would be in use at the next attempt.
        except BaseException:
            await self._close()
            raise

    async def disconnect(self) -> None:
        """Stop a running motion and close both channels."""
        try:
            if self._command.running and self._state.channel.connected:
                await self.stop()
        finally:
            await self._close()

    def incidents(self) -> tuple[CellError, ...]:
        """Strangers that called on the robot's ports."""
        return self._channels.incidents()

    def state(self, max_age_s: float = 0.25) -> RobotState:
        """The newest report. ``stop_latched`` includes this driver's own latch."""
        state, why = self._state.newest(max_age_s), self._state.missed_beats()
        return latched(state, self._latch, why, running=self._command.running)

    def link_facts(self) -> dict[str, str]:
        """From the hello of both channels."""
        return link_facts({"CMD": self._command.channel, "STA": self._state.channel})

    def round_trips_s(self) -> tuple[float, ...]:
        """Time from the sending of each command of this session to its acceptance.

        Real commands are timed: the protocol has none that does nothing and could serve as a ping.
        """
        return tuple(self._command.round_trips_s)

    def least_acceleration_m_s2(self) -> float:
        """The least that the job program can be told: one percent, where it takes percents."""
        return self._command.words.least_acceleration_mm_s2 * MM

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """MOVJ. With a dh table, refused when the flange would leave its box on the way."""
        joints_deg, percent = self._bounds.joints(joints_rad, speed_ratio)
        words = self._command.words
        return await self._move(
            lambda session, seq: words.move_joint(session, seq, joints_deg.tolist(), percent),
            self._targets.joints(joints_rad),
        )

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """MOVL to standstill. With a dh table, refused when the arm cannot follow the way."""
        self._bounds.pose(base_T_flange)
        speed = self._bounds.speed_mm_s(speed_m_s)
        least_m_s2 = self.least_acceleration_m_s2()
        acceleration = self._bounds.acceleration_mm_s2(acceleration_m_s2, least_m_s2=least_m_s2)
        words, written = self._command.words, self._command.written
        return await self._move(
            lambda session, seq: words.move_linear(
                session, seq, written(base_T_flange), speed, acceleration
            ),
            self._targets.flange(base_T_flange),
        )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """STEP, at most as long as both the configuration and the job program allow."""
        self._bounds.pose(base_T_flange)
        speed = self._bounds.speed_mm_s(speed_m_s)
        state = self.state(self._config.stale_s)
        self._bounds.step(state, base_T_flange, self._command.channel.hello.step_max_mm)
        words, written = self._command.words, self._command.written
        return await self._move(
            lambda session, seq: words.step(session, seq, written(base_T_flange), speed),
            self._targets.flange(base_T_flange),
        )

    def stream_offer(self) -> StreamOffer:
        """What the job program has offered in its hello, as far as the configuration allows it."""
        self._channels.require_connected()
        hello = self._command.channel.hello
        if hello.stream is None:
            raise StreamNotOffered(f"{self.name}: job program {hello.job_version}")
        return self._bounds.stream_offer(hello.stream)

    @asynccontextmanager
    async def stream(self, limits: StreamLimits) -> AsyncIterator[PoseStream]:
        """STREAM, then a SET for each tick, then FINISH; stops the arm when it is left early."""
        offer = self.stream_offer()
        figures = self._bounds.stream(limits, offer)
        self._check_ready()
        command: RunningCommand | None = None
        try:
            async with self._command.command(
                lambda session, seq: protocol.begin_stream(session, seq, figures)
            ) as command:
                stream = SiasunStream(self._command.channel, command, self._bounds, limits, offer)
                async with followed(stream, self._config.stop_timeout_s):
                    yield stream
        except BaseException as error:
            await self._leave_stream(error, command)
            await self._state.raise_controller_error(error)
            raise
        await self._state.wait(lambda status: not status.moving, self._config.reply_timeout_s)

    async def _leave_stream(self, error: BaseException, command: RunningCommand | None) -> None:
        """Stop the robot unless its controller has said that it has. ``command`` is None as long
        as the controller has not accepted the stream."""
        known_to_stand = isinstance(error, CellError) and not isinstance(error, ReplyTimeout)
        if command is None and known_to_stand:
            return
        if command is not None and command.over and known_to_stand:
            self._latch = self._latch or NotRearmed(f"{self.name}: a stream ended early")
            return
        await self._stop_before_leaving()

    async def stop(self) -> None:
        """ABORT on STA; returns after STOPD. Without it both channels are closed until ``connect``:
        no heartbeat and no link, so that the controller's dead man and its watch over the links
        stop the arm, which do not depend on the part of the job program that did not answer."""
        # Before anything is sent or awaited, so that no move can begin while the stop is under way.
        self._latch = NotRearmed(f"{self.name}: a stop was requested")
        try:
            await self._state.stop(self._config.stop_timeout_s)
        except StopFailed as fault:
            self._latch = fault
            await self._close()
            raise

    async def rearm(self) -> None:
        """REARM; returns when the state shows the latch released."""
        if self._command.running:
            raise MotionRejected(f"{self.name}: cannot rearm while a motion runs")
        self._channels.require_connected()
        # Remembered, so that a stop that comes during the release is not released with it.
        latch = self._latch
        await self._command.run(self._command.words.rearm, self._config.reply_timeout_s)
        await self._state.wait(lambda status: not status.latched, self._config.reply_timeout_s)
        if self._latch is not latch:
            raise NotRearmed(f"{self.name}: {self._latch}, while it was re-armed")
        self._latch = None
        self._state.forget_pauses()

    async def _move(self, build: Callable[[int, int], bytes], target: MotionTarget) -> RobotState:
        """Run one motion to standstill; leave it early only after stopping the robot."""
        self._check_ready()
        target.check_way(self.state(self._config.stale_s))
        try:
            base_T_flange = await self._command.run(build, self._config.move_timeout_s)
        # The arm may still move, and nobody waits for its end any more.
        except (asyncio.CancelledError, ReplyTimeout):
            await self._stop_before_leaving()
            raise
        except (MotionAborted, ControllerFault, LinkLost) as fault:
            self._latch = self._latch or fault
            await self._state.raise_controller_error(fault)
            raise
        await self._state.wait(lambda status: not status.moving, self._config.reply_timeout_s)
        state = self.state(self._config.stale_s)
        # The pose of DONE is the encoder pose at standstill, and newer than the last report.
        end = replace(state, base_T_flange=base_T_flange)
        # The controller has another idea of the target, such as another frame: all moves are wrong.
        if off := target.off(end):
            self._latch = MotionAborted(f"{self.name} reports its end {off} away from the target")
            raise self._latch
        return end

    def _check_ready(self) -> None:
        if self._command.running:
            raise MotionRejected(f"{self.name}: another motion is running")
        self._channels.require_connected()
        if self._latch is not None:
            raise NotRearmed(f"{self.name}: {self._latch}") from self._latch
        state = self.state(self._config.stale_s)
        faults.check_ready(self.name, state, self._state.missed_beats())
        self._bounds.table_fits(state)

    async def _stop_before_leaving(self) -> None:
        """Stop even if cancelled again; without a link the controller's dead man does it."""
        self._latch = NotRearmed(f"{self.name}: a motion was given up")
        if self._state.channel.connected:
            await asyncio.shield(asyncio.ensure_future(self.stop()))

    async def _close(self) -> None:
        self._connected = False
        await self._channels.close(LinkLost(f"{self.name} was disconnected"))

    def _on_stopped(self) -> None:
        """Standstill is confirmed: whatever ran has ended, even if its ABRT got lost."""
        self._command.fail(MotionAborted(f"{self.name}: stop was requested (STOP)"))

    def _on_command_lost(self, fault: LinkError) -> None:
        self._latch = fault
        self._command.fail(fault)
        # The main job of SJL/2 reads nothing while it moves the arm, so it does not notice that its
        # channel is gone. Its background job reads STA and can still stop the arm.
        if self._state.channel.hello.compact:
            self._state.request_stop()

    def _on_state_lost(self, fault: LinkError) -> None:
        """Drop the other channel too: nobody sees the arm any more, and a robot that has restarted
        cannot come back as long as its old connection seems to live."""
        self._on_command_lost(fault)
        self._command.channel.drop(fault)
