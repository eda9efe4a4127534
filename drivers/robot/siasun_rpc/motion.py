"""One motion of the arm, from its call to its end by the controller's task states."""

import asyncio
from typing import cast

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, ReplyTimeout
from cellctl.errors.robot import NotRearmed
from drivers.robot.siasun_rpc import faults
from drivers.robot.siasun_rpc.codec.messages import Request, Value
from drivers.robot.siasun_rpc.config import SiasunRpcConfig
from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.connections.link import RpcLink
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.readiness import check_ready
from drivers.robot.siasun_rpc.vendor import TaskState

GOING_ON = {TaskState.IDLE, TaskState.RUNNING}
STILL_ALIVE = GOING_ON | {TaskState.PAUSED}
"""States after which the arm may move again without a call of ours."""


class Motion:
    """``over`` says that the controller itself has ended it, or never begun it."""

    def __init__(self, robot: str, config: SiasunRpcConfig, link: RpcLink) -> None:
        self.over = True
        self.task = 0
        self._robot = robot
        self._config = config
        self._link = link
        self._ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def end(self, fault: CellError) -> None:
        """End it from elsewhere: whoever waits for it gets this fault, and so does a call that
        has not been sent yet. The first fault counts."""
        if not self._ended.done():
            self._ended.set_exception(fault)
            self._ended.exception()  # nobody needs to ask for it

    def raise_end(self) -> None:
        """Raise what has ended it, if anything has."""
        if self._ended.done():
            self._ended.result()

    async def pause(self, duration_s: float) -> None:
        """Wait, but not beyond its end; raises what has ended it."""
        await asyncio.wait({self._ended}, timeout=max(0.0, duration_s))
        self.raise_end()

    async def begin(self, call: Request) -> None:
        """Send a call that moves the arm and take the number of its task."""
        self.raise_end()
        # From here on nobody knows whether the arm moves, until the controller has said so.
        self.over = False
        _, task, _ = await self._exchange(self._link.motion, *self._link.under_dead_man(call))
        self.task = cast(int, task)
        if self.task < 0:
            self.over = True
            texts = await self._link.vendor_errors()
            raise faults.refused(self._robot, call.method, self.task, texts)
        await self.check_guard()

    async def check_guard(self) -> None:
        """Raise ``NotRearmed`` when the guard has stopped the arm since it was last acknowledged.

        The guard writes its count between two stops. Either it is read here, after the motion has
        begun, or the guard's second stop comes after the motion has begun: no order of the two ends
        with an arm that moves on.
        """
        stop_word, rearm_word = self._config.stop_word, self._config.rearm_word
        if stop_word is None or rearm_word is None:
            return
        stops, acknowledged = await self._exchange(
            self._link.control,
            request("read_word_reg", stop_word),
            request("read_word_reg", rearm_word),
        )
        if stops != acknowledged:
            raise NotRearmed(f"{self._robot}: the guard has stopped the arm")

    async def finish(self, timeout_s: float) -> None:
        """Wait for its good end and for standstill; raises what has ended it otherwise, or
        ``ReplyTimeout``."""
        question = request("get_noneblock_taskstate", self.task)
        try:
            async with asyncio.timeout(timeout_s):
                while await self._ask(question) != TaskState.FINISHED:
                    self.check_state()
                    await self.pause(self._config.poll_period_s)
        except TimeoutError:
            facts = f"{self._robot}: task {self.task} has no end after {timeout_s:g} s"
            raise ReplyTimeout(facts) from None
        # The task is finished, but the arm may not stand yet. If it does not come to rest, whoever
        # leaves the motion has to stop it.
        self.over = False
        await self._link.watch.stands(self._config.stop_timeout_s)
        self.over = True

    def check_state(self) -> None:
        """Raise what keeps the arm from moving on: mode, drives, safety, an error, the guard; or
        that none of them is known any more."""
        report, frame = self._link.watch.newest(self._config.silence_s)
        check_ready(self._robot, report, frame, self._config.error_words(frame.error))

    async def unless_bad_end(self, state: int) -> int:
        """Give the state back, or raise the fault of a task that has ended badly."""
        self.over = state not in STILL_ALIVE
        if state in GOING_ON or state == TaskState.FINISHED:
            return state
        raise faults.ended(self._robot, state, await self._link.vendor_errors())

    async def _ask(self, question: Request) -> int:
        (state,) = await self._exchange(self._link.motion, question)
        self.raise_end()
        return await self.unless_bad_end(cast(int, state))

    async def _exchange(self, connection: RpcConnection, *requests: Request) -> list[Value]:
        """Send calls and wait for all replies; raises what has ended the motion rather than that
        this connection, which falls with all others, was closed."""
        try:
            return await connection.exchange(*requests, timeout_s=self._config.reply_timeout_s)
        except LinkError:
            self.raise_end()
            raise
