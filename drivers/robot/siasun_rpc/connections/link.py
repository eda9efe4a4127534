"""All connections to one controller: they stand together and fall together."""

import asyncio
import contextlib
from collections.abc import Callable, Coroutine
from typing import cast

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import ConnectTimeout, LinkError, LinkLost
from drivers.robot.siasun_rpc.codec.messages import MethodUnknown, Request, Value
from drivers.robot.siasun_rpc.config import SiasunRpcConfig
from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.connections.background import BackgroundTasks
from drivers.robot.siasun_rpc.connections.frame_stream import FrameStream
from drivers.robot.siasun_rpc.features import ControllerFeatures, features
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.watch import StateWatch

STOP = request("stop", False)  # noqa: FBT003 - "block": the reply is not to wait for standstill
_MOVES = frozenset({"movej", "movel"})
"""Calls that lead far. A setpoint of a stream leads no farther than one step, and is not waited
for: a controller that answers none has the stream stopped."""
VERSION = request("get_robot_version")
_BEATS = frozenset({"rpc_heartbeat"})
BEATS_PER_DEADMAN = 4
"""Heartbeats in the time after which the controller stops the arm: two in a row may be late."""
RECONNECT_S = 0.3
"""Pause between two attempts to open the connections again. The arm stands meanwhile: without a
heartbeat the controller has stopped it."""
REPEAT_STOP_S = 0.3
"""A stop after which the arm does not stand is sent again after this time, in which an arm that
obeys has come to rest."""


class RpcLink:
    """Four connections to the service and one to the state stream.

    ``motion`` carries what moves the arm, ``control`` the stop and what is asked beside a motion,
    a third one the questions of ``watch``, a fourth one the heartbeats. A fault of any of them ends
    all: an arm of which one part is not known is not known. Before they are dropped a stop is sent,
    and they are opened again until ``close``; ``on_lost`` hears of each loss.

    A move that the network holds back may reach the controller when this process is dead and the
    guard's last stop is past. So ``motion`` has a dead man of its own, which each move brings along
    (``under_dead_man``), and what of it is still in this PC dies with the process.
    """

    def __init__(
        self, robot: str, config: SiasunRpcConfig, on_lost: Callable[[LinkError], None]
    ) -> None:
        self._robot = robot
        self._config = config
        self._on_lost = on_lost
        self._heartbeat = request("rpc_heartbeat", config.heartbeat_ms)
        self._lapse_s = 0.0
        """When the controller has stopped the arm for the last connection that ended with its
        heartbeats."""
        self.up = False
        self._wanted = False
        """True between ``open`` and ``close``: a session that is lost meanwhile is made again."""
        self.features = ControllerFeatures("", streams=False)
        self._new_session()
        self.watch = StateWatch(robot, config, self._asking, self._frames)
        self._jobs = BackgroundTasks()
        self._reopening: asyncio.Task[None] | None = None
        self._down: asyncio.Future[None] | None = None
        """Carries the fault that has ended the present connections."""

    async def open(self) -> None:
        """Connect, ask for the version, wait for a first state. Sends nothing that moves or
        switches anything. Idempotent. ``ConnectTimeout``, ``VersionMismatch`` or another fault of
        the link."""
        if self.up or self._reopening is not None:
            return
        await self._open()
        # Only now: a first connection that fails is told to the caller and not tried again behind
        # its back.
        self._wanted = True

    def _new_session(self) -> None:
        """Connections that nothing of an earlier session can reach: neither its late end nor a
        reply that comes after all."""
        self.motion = self._motion_connection()
        self.control = RpcConnection(f"{self._robot} control", self.drop)
        self._asking = RpcConnection(f"{self._robot} state", self.drop)
        self._beating = RpcConnection(f"{self._robot} heartbeat", self.drop)
        self._frames = FrameStream(f"{self._robot} state stream", self.drop)

    def _motion_connection(self) -> RpcConnection:
        return RpcConnection(f"{self._robot} motion", self.drop, dies_with_process=True)

    def under_dead_man(self, move: Request) -> tuple[Request, Request, Request]:
        """A call that moves the arm between two heartbeats, to be sent in one piece.

        The controller watches heartbeats for each connection by itself. Whenever this piece
        arrives, it stops the arm ``heartbeat_ms`` later if nothing follows: the death of this
        process bounds a move that it has not lived to see. Before and behind, so that the move has
        a heartbeat with it wherever the network cuts the piece.
        """
        return self._heartbeat, move, self._heartbeat

    async def lapsed(self) -> None:
        """Wait until no connection that has ended can have the arm stopped any more: the stop
        would hit the next motion. ``heartbeat_ms`` at most."""
        await asyncio.sleep(max(0.0, self._lapse_s - now_s()))

    def _lapse(self) -> None:
        self._lapse_s = now_s() + self._config.heartbeat_ms / 1000.0

    async def _open(self) -> None:
        config = self._config
        await self.lapsed()
        self._new_session()
        self.watch.follow(self._asking, self._frames)
        self._down = asyncio.get_running_loop().create_future()
        # Before the first connection stands, because ``drop`` ignores the faults of a link that is
        # not up, and one that breaks while the others are opened must end them all.
        self.up = True
        try:
            async with asyncio.timeout(config.connect_timeout_s):
                for one in (self.motion, self.control, self._asking, self._beating):
                    await one.open(config.host, config.rpc_port)
                await self._frames.open(config.host, config.state_port)
                self.features = features(cast(str | None, await self.ask_if_known(VERSION)))
                self._jobs.start(self._keep(self._beat()))
                self._jobs.start(self._keep(self.watch.run()))
                await self._first_state(self._down)
        except TimeoutError:
            self._hang_up()
            place = f"{config.host}:{config.rpc_port} and {config.state_port}"
            facts = f"{self._robot}: no state within {config.connect_timeout_s:g} s from {place}"
            raise ConnectTimeout(facts) from None
        except BaseException:
            self._hang_up()
            raise

    def facts(self) -> dict[str, str]:
        """What is known of the controller, in words by name."""
        service = "connected" if self.up else "not connected"
        return {
            "service": f"{service}, four connections and the state stream",
            "controller software": self.features.version or "names no version",
            "streamed motion": "known" if self.features.streams else "not known to this driver",
            "tool and work object": f"{self._config.tool} and {self._config.work_frame}",
            "dead man": f"{self._config.heartbeat_ms} ms",
        }

    def drop(self, fault: LinkError) -> None:
        """End everything because of a fault, after a last stop if that can still be sent."""
        if not self.up:
            return
        self.control.send(STOP)
        self._hang_up()
        if self._down is not None and not self._down.done():
            self._down.set_exception(fault)
            self._down.exception()  # it is told by ``on_lost``, and only ``open`` asks here
        self._on_lost(fault)
        if self._wanted and self._reopening is None:
            self._reopening = asyncio.create_task(self._reopen())

    def close(self) -> None:
        """Drop all connections and open them no more. Idempotent."""
        self._wanted = False
        if self._reopening is not None:
            self._reopening.cancel()
            self._reopening = None
        self._hang_up()

    async def stop_until_standing(self) -> None:
        """Ask the arm to stop until it is reported to stand. The caller limits the time.

        The controller has no latch, and a stop may overtake a move, which goes over a connection of
        its own: what was not answered before the stop may begin after it. So only a stop that comes
        after the answer to every move counts.
        """
        while True:
            overtaken = self.owes_move
            await self.control.exchange(STOP, timeout_s=self._config.reply_timeout_s)
            if overtaken:
                await self.motion.next_reply(REPEAT_STOP_S)
                continue
            standing = asyncio.ensure_future(self.watch.stands(self._config.stop_timeout_s))
            try:
                await asyncio.wait({standing}, timeout=REPEAT_STOP_S)
                if standing.done():
                    return standing.result()
            finally:
                standing.cancel()

    @property
    def owes_move(self) -> bool:
        """The controller has not answered a move yet: nobody knows whether it will begin."""
        return self.motion.owes(_MOVES)

    async def _reopen(self) -> None:
        """Try until the controller is back. The arm is stopped before anything else: nobody has
        seen what it did meanwhile."""
        while not self.up:
            await asyncio.sleep(RECONNECT_S)
            # Whoever uses the robot has been told of the loss, and hears of it at every call.
            with contextlib.suppress(CellError):
                await self._open()
                await self.control.exchange(STOP, timeout_s=self._config.reply_timeout_s)
        self._reopening = None

    def _hang_up(self) -> None:
        if self.up:
            self._lapse()
        self.up = False
        self._jobs.cancel()
        for one in (self.motion, self.control, self._asking, self._beating):
            one.close()
        self._frames.close()

    async def renew_motion(self) -> None:
        """Replace the motion connection by a new one; replies to the old one are not awaited.

        The controller answers the calls of a connection in their order, so that the next motion
        would wait behind those that it has not answered.
        """
        self.motion.close()
        if not self.up:
            return
        self._lapse()
        self.motion = self._motion_connection()
        try:
            async with asyncio.timeout(self._config.connect_timeout_s):
                await self.motion.open(self._config.host, self._config.rpc_port)
        except TimeoutError:
            self.drop(LinkLost(f"{self.motion}: no new connection"))
        except LinkError as fault:
            self.drop(fault)

    async def vendor_errors(self) -> list[str]:
        """The controller's own list of errors, for a text; empty when it cannot be had."""
        try:
            (texts,) = await self.control.exchange(
                request("get_last_error"), timeout_s=self._config.reply_timeout_s
            )
        except CellError:
            return []  # the fault that made somebody ask is told without it
        return cast(list[str], texts)

    async def _first_state(self, down: "asyncio.Future[None]") -> None:
        first = asyncio.ensure_future(self.watch.until_first(self._config.connect_timeout_s))
        try:
            await asyncio.wait({first, down}, return_when=asyncio.FIRST_COMPLETED)
            if down.done():
                down.result()
            first.result()
        finally:
            first.cancel()

    async def ask_if_known(self, question: Request) -> Value:
        """The answer to a question that a controller may not know; None then."""
        try:
            (answer,) = await self.control.exchange(
                question, timeout_s=self._config.reply_timeout_s
            )
        except MethodUnknown:
            return None
        return answer

    async def _keep(self, job: Coroutine[None, None, None]) -> None:
        """A job that ends, by whatever, takes the link with it: nobody would watch the arm."""
        session = self._down
        try:
            await job
        except LinkError as fault:
            if self._down is session:
                self.drop(fault)
        finally:
            # Cancelled by the end of its session, it may come here when the next one has begun.
            if self._down is session:
                self.drop(LinkLost(f"{self._robot}: heartbeat or state has ended"))

    async def _beat(self) -> None:
        interval_s = self._config.heartbeat_ms / 1000.0 / BEATS_PER_DEADMAN
        loop = asyncio.get_running_loop()
        while True:
            due_s = loop.time() + interval_s
            # Nobody waits for its reply: a controller that owes one is sent no other, and stops.
            if not self.motion.owes(_BEATS):
                self.motion.send(self._heartbeat)
            await self._beating.exchange(self._heartbeat, timeout_s=self._config.silence_s)
            await asyncio.sleep(max(0.0, due_s - loop.time()))
