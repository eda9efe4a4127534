"""What a controller's job programs decide, without I/O: records and times in, records out."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fakes.faults import FaultBoard
from fakes.scenario_file.sections import Channel
from fakes.wire.sjl.panel import Panel
from fakes.wire.sjl.records import RecordError, integer, number, pose_fields
from fakes.wire.sjl.stream import Stream, StreamLimits, StreamOffer
from fakes.world.frames import MM, from_written
from fakes.world.robot import RefusedMotionError, RobotArm

Record = list[str]
Outbox = list[tuple[Channel, Record]]

_FIELDS = {"MOVJ": 10, "MOVL": 11, "STEP": 10, "REARM": 3, "STREAM": 8, "SET": 9, "FINISH": 3}
_EMERGENCY_LATENCY_S = 0.02
"""An emergency stop and drives without power act past the job program, without its dead time."""
_STEP_RISE_PER_S = 10.0
"""A ``STEP`` names no acceleration: it reaches its speed in a tenth of a second."""


@dataclass(slots=True)
class Link:
    """One channel while it is open."""

    session: int
    beat_s: float
    last_seq: int = 0


@dataclass(slots=True)
class _Motion:
    seq: int
    begun_s: float
    reason: str | None = None
    """Why it is being stopped."""
    stream: Stream | None = None
    finished: bool = False
    """FINISH has come for the stream."""

    @property
    def streaming(self) -> bool:
        """A stream goes on: the arm may stand, and yet this motion has not ended."""
        return self.stream is not None and self.reason is None and not self.finished


@dataclass(slots=True)
class Controller:
    """State of one controller: links, latch, panel, the motion that is under way."""

    arm: RobotArm
    faults: FaultBoard
    offer: StreamOffer | None = None
    """What is offered for streamed motion; None for a job program that cannot."""
    booted_s: float = 0.0
    contact_closed: Callable[[], bool] = lambda: True
    """Whether the PC's digital output in the permit loop is closed."""
    links: dict[Channel, Link] = field(default_factory=dict)
    lost: set[Channel] = field(default_factory=set)
    """Channels that were open and have not come back."""
    latched: bool = False
    _motion: _Motion | None = None
    _stops: list[tuple[Channel, int]] = field(default_factory=list)
    _held_set: Record | None = None
    """A setpoint that the fault ``set_late`` keeps back."""

    @property
    def panel(self) -> Panel:
        """Key, button, drives and error number."""
        return Panel(self.faults, self.arm.by_hand)

    def moving(self, time_s: float) -> bool:
        """The arm moves, or follows a stream, in which it may stand between two steps."""
        streaming = self._motion is not None and self._motion.streaming
        return streaming or self.arm.moving(time_s)

    # -- links --------------------------------------------------------------------------------
    def opened(self, channel: Channel, session: int, time_s: float) -> None:
        """A channel was accepted by the PC."""
        self.links[channel] = Link(session, time_s)
        self.lost.discard(channel)

    def closed(self, channel: Channel, time_s: float) -> None:
        """A channel is gone: stop and latch."""
        if self.links.pop(channel, None) is None:
            return
        self.lost.add(channel)
        # Nobody is left on that channel to hear that the arm stands.
        self._stops = [stop for stop in self._stops if stop[0] != channel]
        self._halt(time_s, "LINK")

    # -- records ------------------------------------------------------------------------------
    def command(self, fields: Record, time_s: float) -> Outbox:
        """A record on CMD; raises ``RecordError``."""
        word = fields[0]
        if _FIELDS.get(word) != len(fields):
            raise RecordError(f"not a command: {fields}")
        session, seq = integer(fields[1]), integer(fields[2])
        values = [number(text) for text in fields[3:]]
        if word in {"SET", "FINISH"}:
            self._streamed(fields, session)
            return []
        if refusal := self._out_of_order(session, seq):
            return [("CMD", refusal)]
        if self.faults.use("never_ack"):
            return []
        try:
            if word == "REARM":
                return self._rearm(seq, time_s)
            self._move(word, seq, values, time_s)
        except RefusedMotionError as refused:
            return [("CMD", ["REJ", str(seq), refused.reason])]
        return [("CMD", ["ACK", str(seq)])]

    def supervise(self, channel: Channel, fields: Record, time_s: float) -> Outbox:
        """A record on STA or GRD; raises ``RecordError``."""
        if len(fields) != 3 or fields[0] not in {"BEAT", "ABORT"}:
            raise RecordError(f"not a heartbeat or stop: {fields}")
        session, count = integer(fields[1]), integer(fields[2])
        if fields[0] == "BEAT":
            link = self.links[channel]
            # A beat of an earlier session says nothing about the PC of this one.
            if session == link.session:
                link.beat_s = time_s
            return []
        if self.faults.use("ignore_stop"):
            return []
        self._stops.append((channel, count))
        self._halt(time_s, "STOP")
        return []

    def tick(self, time_s: float) -> Outbox:
        """What has become due: dead man, panel, end of a motion, end of a stop."""
        self._supervise_links(time_s)
        self._supervise_panel(time_s)
        if not (self.latched or self.contact_closed()):
            self._halt(time_s, "STOP")
        out = self._advance_stream(time_s)
        # Both kinds of answer are given at standstill, and not before.
        if self.moving(time_s) or not (self._motion or self._stops):
            return out
        pose = pose_fields(self.arm.encoder_matrix(time_s))
        motion, self._motion = self._motion, None
        if motion is not None and not self.faults.use("never_done"):
            seq, reason = str(motion.seq), motion.reason or "ERROR"
            cut_short = motion.reason is not None if motion.stream else self.arm.cut_short
            ended = ["ABRT", seq, reason] if cut_short else ["DONE", seq]
            out.append(("CMD", [*ended, *pose]))
        out += [(channel, ["STOPD", str(number), *pose]) for channel, number in self._stops]
        self._stops = []
        return [(channel, record) for channel, record in out if channel in self.links]

    # -- inside -------------------------------------------------------------------------------
    def _out_of_order(self, session: int, seq: int) -> Record | None:
        """The answer to a command of another session or with a number that is not the next one."""
        link = self.links["CMD"]
        if session != link.session:
            return ["REJ", str(seq), "SESSION"]
        if seq <= link.last_seq:
            return ["DUP", str(seq)]
        if seq != link.last_seq + 1:
            return ["REJ", str(seq), "SEQ"]
        link.last_seq = seq
        return None

    def _rearm(self, seq: int, time_s: float) -> Outbox:
        if self.panel.emergency_stop:
            raise RefusedMotionError("ESTOP")
        stopping = self._stops or (self.latched and self.arm.moving(time_s))
        if self.lost or stopping or not self.contact_closed():
            raise RefusedMotionError("LATCHED")
        if self._motion is not None:
            raise RefusedMotionError("BUSY")
        self.latched = False
        pose = pose_fields(self.arm.encoder_matrix(time_s))
        return [("CMD", ["ACK", str(seq)]), ("CMD", ["DONE", str(seq), *pose])]

    def _move(self, word: str, seq: int, values: list[float], time_s: float) -> None:
        """Begin a motion or a stream; raises ``RefusedMotionError``."""
        self._check_ready()
        rejected = self.faults.use("reject")
        if rejected:
            raise RefusedMotionError(rejected.text("reason", "LIMIT"))
        self.arm.override_percent = 0 if self.faults.active("override_zero") else 100
        stream = None
        if word == "STREAM":
            stream = self._stream(StreamLimits(*values), time_s)
        elif word == "MOVJ":
            self.arm.start_joint(time_s, np.deg2rad(values[:6]), values[6])
        else:
            target = from_written(values[:6])
            if word == "STEP":
                self.arm.check_step(time_s, target)
            acceleration = values[7] if word == "MOVL" else _STEP_RISE_PER_S * values[6]
            self.arm.start_linear(time_s, target, values[6] * MM, acceleration * MM)
        self._motion = _Motion(seq, time_s, stream=stream)

    def _stream(self, limits: StreamLimits, time_s: float) -> Stream:
        if self.offer is None or not limits.within(self.offer.limits):
            raise RefusedMotionError("STREAM")
        return Stream(self.arm, self.offer, limits, time_s)

    def _streamed(self, fields: Record, session: int) -> None:
        """SET or FINISH; ignored when of another session, or without a stream that goes on."""
        motion = self._motion
        if motion is None or motion.stream is None or not motion.streaming:
            return
        if session != self.links["CMD"].session:
            return
        if fields[0] == "FINISH":
            motion.finished = integer(fields[2]) == motion.seq
            return
        if self.faults.use("set_lost"):
            return
        held, self._held_set = self._held_set, None
        if self.faults.use("set_late"):
            self._held_set = fields
        heard = [] if self._held_set else [fields]
        repeated = heard if self.faults.use("set_repeated") else []
        try:
            for record in [*([held] if held else []), *heard, *repeated]:
                motion.stream.take(integer(record[2]), [number(text) for text in record[3:]])
        except RefusedMotionError as refusal:
            self._hold(motion, refusal.reason)

    def _advance_stream(self, time_s: float) -> Outbox:
        """The tick of a stream that has become due."""
        motion = self._motion
        if motion is None or motion.stream is None:
            return []
        try:
            advance = motion.stream.tick if motion.streaming else motion.stream.coast
            if not advance(time_s) or self.faults.active("ticks_silent"):
                return []
        except RefusedMotionError as refusal:
            self._hold(motion, refusal.reason)
            return []
        robot_ms = 1000 * (time_s - self.booted_s)
        return [("CMD", motion.stream.record(robot_ms))]

    def _check_ready(self) -> None:
        refusals = {
            "BUSY": self._motion is not None,
            "ESTOP": self.panel.emergency_stop,
            "MODE": self.panel.mode != "REM",
            "DRIVES": not self.panel.drives,
            "ERROR": self.panel.error_code != 0,
            "LATCHED": self.latched or bool(self.lost) or "STA" not in self.links,
        }
        for reason, applies in refusals.items():
            if applies:
                raise RefusedMotionError(reason)

    def _hold(self, motion: _Motion, reason: str) -> None:
        """End a stream at the last setpoint that was taken. The arm is on its way there and no
        further, so nothing has to be braked."""
        self.latched = True
        motion.reason = reason

    def _halt(self, time_s: float, reason: str, *, latency_s: float | None = None) -> None:
        self.latched = True
        slow = self.faults.active("stop_latency")
        if latency_s is None and slow:
            latency_s = slow.number("latency_s", 0.5)
        if self._motion is not None:
            self._motion.reason = self._motion.reason or reason
        if self.arm.moving(time_s):
            self.arm.stop(time_s, latency_s=latency_s)

    def _supervise_links(self, time_s: float) -> None:
        deadman_s = self.arm.settings.deadman_ms / 1000
        for channel, link in self.links.items():
            if channel != "CMD" and time_s - link.beat_s > deadman_s and not self.latched:
                self._halt(time_s, "DEADMAN")

    def _supervise_panel(self, time_s: float) -> None:
        if self._motion is None:
            self.latched = self.latched or self.panel.emergency_stop
            return
        elapsed_s = time_s - self._motion.begun_s
        pressed = self.faults.active("emergency_stop_mid_move")
        if pressed and elapsed_s >= pressed.number("after_s", 0.2):
            self.faults.clear("emergency_stop_mid_move")
            self.faults.inject("emergency_stop")
        if self.panel.emergency_stop:
            self._halt(time_s, "ESTOP", latency_s=_EMERGENCY_LATENCY_S)
        elif self.panel.mode != "REM":
            self._halt(time_s, "MODE")
        elif not self.panel.drives:
            self._halt(time_s, "DRIVES", latency_s=_EMERGENCY_LATENCY_S)
        elif self.panel.error_code:
            self._halt(time_s, "ERROR")
        abort = self.faults.active("abort")
        if abort and elapsed_s >= abort.number("after_s", 0.2):
            self.faults.use("abort")
            self._halt(time_s, abort.text("reason", "ERROR"))
