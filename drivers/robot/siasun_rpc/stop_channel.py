"""The guard's connections to a collaborative arm: blocking sockets, no event loop, no arrays."""

import math
import select
from typing import cast

from cellctl.clock import now_s
from cellctl.errors.link import ConnectTimeout, LinkLost, ProtocolViolation
from cellctl.interfaces.stop_channel import FlangeState, StopChannel
from drivers.robot.siasun_rpc.codec.guard_calls import packed
from drivers.robot.siasun_rpc.codec.messages import Request, Value
from drivers.robot.siasun_rpc.config import SiasunRpcStopChannelConfig
from drivers.robot.siasun_rpc.connections.blocking_line import BlockingLine

WORDS = 32_767
"""Stops are counted from 1 to here and then from 1 again. The manual does not say whether a word
register has a sign, and up to here both readings are the same number."""
STOP = packed("stop", False)  # noqa: FBT003 - "block": nobody waits for the reply


class SiasunRpcStopChannel(StopChannel):
    """Three connections: one for stops alone, one for heartbeats, one for questions.

    The controller has no latch. A stop is therefore three calls in one piece: stop, count the stop
    in a word register, stop again. A motion that the daemon begins between the two stops is stopped
    by the second; one that it begins later is one whose driver sees the count and stops it.
    """

    Config = SiasunRpcStopChannelConfig

    def __init__(self, config: SiasunRpcStopChannelConfig) -> None:
        self._config = config
        peer = f"guard's channel to {config.host}:{config.rpc_port}"
        self._stop, self._beat, self._ask = (
            BlockingLine(f"{peer} ({purpose})") for purpose in ("stop", "heartbeat", "state")
        )
        self._poll: select.epoll | None = None
        self._stops = 0
        self._stop_data: tuple[Request, ...] = ()
        self._was_lost = False
        self._questions = (
            # Before the pose, so that the pose of an arm that stands is the one where it stands.
            packed("robotmoving"),
            packed("get_tcp_pose_coord", config.tool, config.work_frame),
            packed("read_word_reg", config.stop_word),
            packed("read_word_reg", config.rearm_word),
        )
        self._beat_data = packed("rpc_heartbeat", config.heartbeat_ms)

    def open(self) -> None:
        """Connect and read the count of stops; ``ConnectTimeout`` when nobody answers.

        After a loss of the channel the arm is stopped as soon as the controller can be reached
        again: nobody has watched it meanwhile.
        """
        self.close()
        deadline_s = now_s() + self._config.connect_timeout_s
        try:
            for line in self._lines:
                line.open(self._config.host, self._config.rpc_port, deadline_s)
            # Not below the own count: a stop that was sent on the lost connection may reach the
            # controller after this answer, and the next one needs a number that is still unused.
            self._stops = max(self._count_of_stops(deadline_s), self._stops)
        except OSError as error:
            self.close()
            facts = f"{self._config.host}:{self._config.rpc_port}: {error.strerror or 'no answer'}"
            raise ConnectTimeout(facts) from error
        except BaseException:
            self.close()
            raise
        self._poll = select.epoll()
        for line in self._lines:
            line.block(blocking=False)
            self._poll.register(line.fileno(), select.EPOLLIN)
        self._pack_stop()
        if self._was_lost:
            self._was_lost = False
            self.request_stop()

    def close(self) -> None:
        """Drop all connections. Idempotent."""
        for line in self._lines:
            line.close()
        if self._poll is not None:
            self._poll.close()
            self._poll = None

    def fileno(self) -> int:
        """Descriptor that is readable when any of the connections is, -1 while closed."""
        return -1 if self._poll is None else self._poll.fileno()

    def request_stop(self) -> None:
        """Send the stop now; a full or broken socket is ``LinkLost``."""
        # Sent first and packed for the next time afterwards: nothing is computed before a stop
        # leaves.
        self._send(self._stop, *self._stop_data)
        self._pack_stop()

    def heartbeat(self) -> None:
        """Heartbeat, and the questions whose answers ``poll`` reports."""
        self._send(self._beat, self._beat_data)
        # A controller that is slow to answer is not asked more often than it answers.
        if not self._ask.waiting:
            self._send(self._ask, *self._questions)

    def poll(self) -> FlangeState | None:
        """The newest report of those that arrived since the last call; None without one."""
        if self._poll is None:
            raise LinkLost(f"{self._ask} is not connected")
        try:
            for line in (self._stop, self._beat):
                line.read()
            answers = self._ask.read()
            if not answers:
                self._check_silence()
                return None
            return self._report(answers)
        except (LinkLost, ProtocolViolation):
            self._lose()
            raise

    @property
    def _lines(self) -> tuple[BlockingLine, BlockingLine, BlockingLine]:
        return self._stop, self._beat, self._ask

    def _check_silence(self) -> None:
        timeout_s = self._config.reply_timeout_s
        if self._ask.waiting and now_s() - self._ask.asked_s > timeout_s:
            raise LinkLost(f"{self._ask}: no answer in {timeout_s:g} s")

    def _report(self, answers: list[Value]) -> FlangeState:
        moving, pose, stops, acknowledged = answers
        x_m, y_m, z_m, *angles = _six(pose)
        rotation = self._config.euler.rows(*angles)
        latched = stops != acknowledged
        return FlangeState(self._ask.asked_s, (x_m, y_m, z_m), rotation, bool(moving), latched)

    def _count_of_stops(self, deadline_s: float) -> int:
        """The count in the controller, which outlives this process."""
        self._ask.send(*self._questions)
        answers: list[Value] = []
        while not answers:
            self._ask.wait(deadline_s)
            answers = self._ask.read()
        return cast(int, answers[2])

    def _pack_stop(self) -> None:
        self._stops = self._stops % WORDS + 1
        count = packed("write_word_reg", self._config.stop_word, self._stops)
        self._stop_data = (STOP, count, STOP)

    def _send(self, line: BlockingLine, *requests: Request) -> None:
        try:
            line.send(*requests)
        except LinkLost:
            self._lose()
            raise

    def _lose(self) -> None:
        self._was_lost = True
        self.close()


def _six(value: Value) -> list[float]:
    """A pose as the controller writes it: metres, and radians in its own order."""
    numbers = cast(list[float], value)
    if len(numbers) != 6 or not all(map(math.isfinite, numbers)):
        raise ProtocolViolation(f"six finite numbers expected, got {value!r:.120}")
    return numbers
