"""The CMD channel of one robot: sequence numbers, answers, and one command at a time."""

from collections import deque
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, LinkLost, ProtocolViolation
from cellctl.errors.robot import MotionRejected
from drivers.robot.siasun.channels.running_command import RunningCommand
from drivers.robot.siasun.codec.poses import read_pose, write_pose
from drivers.robot.siasun.codec.records import Answer, Record, Tick
from drivers.robot.siasun.codec.words import Words
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.connection import SjlChannel

MOST_COMMANDS = 2_800_000
"""Most commands of one session. A record of SJL/2 ends in the sum of its numbers, which has seven
digits in front of its point. The count of commands may grow by what session number, offsets and
values leave of them, less 0.1 million."""
ROUND_TRIPS = 500
"""How many round trips are remembered, for whoever commissions the link."""


class CommandChannel:
    """Sends a command and waits for its end; ``fail`` ends that wait from elsewhere."""

    def __init__(
        self, robot: str, config: SiasunConfig, on_lost: Callable[[LinkError], None]
    ) -> None:
        self.channel = SjlChannel(
            "CMD",
            config.robot_name,
            max_deadman_s=config.max_deadman_s,
            robot_address=config.robot_address,
            on_up=self._up,
            on_record=self._take,
            on_lost=on_lost,
        )
        self._robot = robot
        self._reply_timeout_s = config.reply_timeout_s
        self._seq = 0
        self._running: RunningCommand | None = None
        self.round_trips_s: deque[float] = deque(maxlen=ROUND_TRIPS)
        """From the sending of each command to its acceptance."""

    @property
    def words(self) -> Words:
        """What the job program understands."""
        return self.channel.words

    def written(self, base_T_flange: RigidTransform) -> list[float]:
        """A pose as the controller of this session reads it."""
        return write_pose(base_T_flange, self.channel.hello.euler_order)

    @property
    def running(self) -> bool:
        """A command waits for its end."""
        return self._running is not None

    async def run(self, build: Callable[[int, int], bytes], timeout_s: float) -> RigidTransform:
        """Send ``build(session, seq)``; the flange pose at its end.

        Raises what the controller answered, what ``fail`` was given, or ``ReplyTimeout``. The
        channel is dropped when the controller is silent or its answer makes no sense.
        """
        async with self.command(build) as command:
            xyzabc = await command.done(timeout_s)
        return read_pose(xyzabc, self.channel.hello.euler_order)

    @asynccontextmanager
    async def command(self, build: Callable[[int, int], bytes]) -> AsyncIterator[RunningCommand]:
        """Send ``build(session, seq)`` and give the command once it is accepted. Leaving the
        context means that nobody waits for its end any more. Raises as ``run`` does."""
        if self._running is not None:
            raise MotionRejected(f"{self._robot}: another motion is running")
        if self._seq >= MOST_COMMANDS:
            # Nothing runs now, and nothing is sent: the robot calls again, for a session that
            # counts from 1, and is re-armed as after any loss of a link.
            self.channel.drop(LinkLost(f"{self.channel}: all numbers of the session are used up"))
            raise LinkLost(f"{self.channel}: a new session begins, Clear and Reset")
        # An answer that comes too late would be taken for one to the next command, so the channel
        # is dropped when this one is not answered as it should be.
        command = self._running = RunningCommand(
            self._robot, self.channel.session, self._seq + 1, self.channel.drop
        )
        try:
            self._seq += 1
            sent_s = now_s()
            self.channel.send(build(command.session, command.seq))
            # A rejection comes at once. Waiting for it before the long wait for the end tells a
            # robot that refuses from one that is slow.
            await command.acknowledged(self._reply_timeout_s)
            self.round_trips_s.append(now_s() - sent_s)
            yield command
        finally:
            self._running = None

    def fail(self, fault: CellError) -> None:
        """End the running command, if any, with a fault."""
        if self._running is not None:
            self._running.take(fault)

    def _up(self) -> None:
        # The protocol counts from 1 in each session (section 4).
        self._seq = 0

    def _take(self, record: Record) -> None:
        """Hand a record to the command that it belongs to.

        Late answers to a command that was given up are passed over, and so are late ticks.
        """
        if isinstance(record, Tick):
            if self._running is not None:
                self._running.take_tick(record)
            return
        if not isinstance(record, Answer):
            raise ProtocolViolation(f"{self.channel}: {type(record).__name__} on this channel")
        # No answer to anything that was sent in this session: the two ends no longer agree, and
        # nothing else on this channel can be believed.
        if not 1 <= record.seq <= self._seq:
            raise ProtocolViolation(f"{self.channel}: {record} to a command that was never sent")
        if self._running is not None and record.seq == self._running.seq:
            self._running.take(record)
