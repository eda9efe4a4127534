"""The STA channel of one robot: newest state, heartbeat, silence watchdog, and stop."""

import asyncio
import math
from collections.abc import Callable

import numpy as np

from cellctl.clock import now_s
from cellctl.errors.link import LinkError, LinkLost, ProtocolViolation, StaleData
from cellctl.errors.robot import ControllerFault, StopFailed
from cellctl.geometry.euler_order import EulerOrder
from cellctl.interfaces.robot import RobotMode, RobotState
from drivers.robot.siasun.channels.after_stop import AfterStop
from drivers.robot.siasun.codec.poses import read_pose
from drivers.robot.siasun.codec.records import Record, Status, StopDone
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.connection import SjlChannel

BEATS_PER_DEADMAN = 4
"""Heartbeats within the time of a dead man. The protocol asks for three (section 6); the fourth is
room for a late one."""
REPEAT_STOP_S = 0.3
"""A stop that is not confirmed is asked for again after this time."""
REASON_S = 0.2
"""Longest wait for the report that says why the controller has ended a command: ten reports."""
_NEARLY = 0.8
"""Share of the dead man's time. A longer pause between two heartbeats is told as the reason of a
latch; see ``missed_beats``."""
_MODES = {"MAN": RobotMode.MANUAL, "AUT": RobotMode.AUTOMATIC, "REM": RobotMode.REMOTE}


class StateChannel:
    """``on_stopped`` hears of confirmed standstill, ``on_lost`` of the end of a session."""

    def __init__(
        self,
        robot: str,
        config: SiasunConfig,
        on_stopped: Callable[[], None],
        on_lost: Callable[[LinkError], None],
    ) -> None:
        self.channel = SjlChannel(
            "STA",
            config.robot_name,
            max_deadman_s=config.max_deadman_s,
            robot_address=config.robot_address,
            on_up=self._up,
            on_record=self._take,
            on_lost=self._lost,
        )
        self._robot = robot
        self._silence_s = config.silence_s
        self._error_words = config.error_words
        self._on_stopped = on_stopped
        self._on_lost = on_lost
        self._status: Status | None = None
        self._state: RobotState | None = None
        """What the newest report says in SI, once somebody has asked for it."""
        self._time_s = 0.0
        self._waiters: dict[asyncio.Future[None], Callable[[Status], bool]] = {}
        self._stops: dict[asyncio.Future[None], int] = {}
        self._abort_id = 0
        self._after_stop = AfterStop()
        self._beats = 0
        self._beat_s = 0.0
        self._longest_pause_s = 0.0
        self._timer: asyncio.TimerHandle | None = None

    def newest(self, max_age_s: float) -> RobotState:
        """The newest report in SI; ``LinkLost`` or ``StaleData`` when there is none to trust."""
        if not self.channel.connected:
            raise LinkLost(f"{self.channel} is not connected")
        age_s = now_s() - self._time_s
        if self._status is None or age_s > max_age_s:
            facts = "none yet" if self._status is None else f"{age_s:.3f} s old"
            raise StaleData(f"state of {self._robot}: {facts}, allowed {max_age_s:g} s")
        # Asked by everything that watches the arm, many times for each report.
        if self._state is None:
            words = self._error_words(self._status.error_code)
            order = self.channel.hello.euler_order
            self._state = _to_state(self._status, self._time_s, words, order)
        return self._state

    async def wait(self, condition: Callable[[Status], bool], timeout_s: float) -> None:
        """Wait until a report that arrives from now on meets a condition; else ``StaleData``."""
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters[future] = condition
        try:
            async with asyncio.timeout(timeout_s):
                await future
        except TimeoutError:
            facts = f"{self._robot} did not report the expected state within {timeout_s:g} s"
            raise StaleData(facts) from None
        finally:
            del self._waiters[future]

    async def raise_controller_error(self, fault: BaseException) -> None:
        """Raise the controller's own error with its number, where one is behind a fault.

        The answer to a command only says that there is an error, and in the compact form the main
        job ends with it and its link is all that is seen to go. Its number comes with a report.
        """
        link_lost = isinstance(fault, LinkLost) and self.channel.hello.compact
        if not self.channel.connected or not (link_lost or isinstance(fault, ControllerFault)):
            return
        # A lost link is told soon: the next report may be from before it, the one after it is not.
        reports = 2 if link_lost else math.inf

        def enough(status: Status) -> bool:
            nonlocal reports
            reports -= 1
            return status.error_code != 0 or reports <= 0

        try:
            await self.wait(enough, REASON_S)
            words = self.newest(REASON_S).error_words
        except LinkError:
            return  # the fault is told without it
        if words:
            raise ControllerFault(f"{self._robot}: controller error {words}") from fault

    def request_stop(self) -> None:
        """Send ABORT once, if a session stands; nobody waits for the standstill."""
        if self.channel.connected:
            self._abort_id += 1
            self.channel.send(self.channel.words.abort(self.channel.session, self._abort_id))

    async def stop(self, timeout_s: float) -> None:
        """Send ABORT and wait for STOPD, repeating the request; ``StopFailed`` without it."""
        self._abort_id += 1
        abort_id = self._abort_id
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._stops[future] = abort_id
        try:
            async with asyncio.timeout(timeout_s):
                # Repeated with the same number, which the protocol allows (section 6): a robot that
                # overheard the first one stops at a later one, and one that has taken it is not
                # confused.
                while not future.done():
                    self.channel.send(self.channel.words.abort(self.channel.session, abort_id))
                    await asyncio.wait({future}, timeout=REPEAT_STOP_S)
                await future
        except TimeoutError:
            facts = f"{self._robot} did not confirm standstill within {timeout_s:g} s"
            raise StopFailed(facts) from None
        except LinkError as error:
            raise StopFailed(f"{self._robot}: {error.detail}") from error
        finally:
            del self._stops[future]

    def forget_pauses(self) -> None:
        """The robot is re-armed: what kept this PC from its heartbeats before counts no longer."""
        self._beat_s, self._longest_pause_s = now_s(), 0.0

    def missed_beats(self) -> str:
        """Words for a latch that nobody has asked for; empty when this PC has sent every beat."""
        deadman_s = self.channel.hello.deadman_ms / 1000.0
        # On the wire and in the controller some of the time is lost as well.
        if self._longest_pause_s < _NEARLY * deadman_s:
            return ""
        return (
            f"this PC has sent no heartbeat for {self._longest_pause_s:.2f} s, its dead man is "
            f"{deadman_s:g} s"
        )

    async def close(self) -> None:
        """Drop the link; whoever waits gets ``LinkLost``."""
        self._cancel_timer()
        await self.channel.close()
        self._fail(LinkLost(f"{self.channel} was disconnected"))

    def _up(self) -> None:
        # A report of the session before says nothing about a controller that may have been
        # restarted.
        self._status = self._state = None
        self._time_s = now_s()
        self.forget_pauses()
        self._beat()

    def _take(self, record: Record) -> None:
        if isinstance(record, Status):
            self._take_status(record)
        elif isinstance(record, StopDone):
            self._take_stop(record)
        else:
            raise ProtocolViolation(f"{self.channel}: {type(record).__name__} on this channel")

    def _take_status(self, status: Status) -> None:
        """Take a report, unless it is no news (``Status.follows``)."""
        if self._status is not None and not status.follows(self._status):
            return
        self._status, self._state, self._time_s = status, None, now_s()
        if self._after_stop.moves_on(status, self._time_s):
            words = f"{self._robot} has confirmed a stop and reports that it moves on"
            self.channel.bar(LinkLost(f"{self.channel}: {words}"))
            return
        # A slow interpreter reads one record in each of its rounds. Unasked heartbeats would
        # queue up before it, and a stop behind them.
        if self.channel.hello.compact:
            self._send_beat()
        for future, condition in self._waiters.items():
            if not future.done() and condition(status):
                future.set_result(None)

    def _take_stop(self, record: StopDone) -> None:
        if not 1 <= record.id <= self._abort_id:
            raise ProtocolViolation(f"{self.channel}: STOPD {record.id} was never asked for")
        for future, abort_id in self._stops.items():
            # STOPD of a later stop confirms the earlier ones too: the robot stands.
            if not future.done() and abort_id <= record.id:
                future.set_result(None)
        self._after_stop.confirmed()
        self._on_stopped()

    def _lost(self, fault: LinkError) -> None:
        self._cancel_timer()
        self._fail(fault)
        self._on_lost(fault)

    def _fail(self, fault: LinkError) -> None:
        for future in (*self._waiters, *self._stops):
            if not future.done():
                future.set_exception(fault)

    def _beat(self) -> None:
        """Heartbeat, and the watchdog over the robot's reports; calls itself again."""
        silent_s = now_s() - self._time_s
        # Checked together with the beat: a robot that does not report may not move on, and without
        # the link it stops by itself.
        if silent_s > self._silence_s:
            self.channel.drop(LinkLost(f"{self.channel}: no report for {silent_s:.2f} s"))
            return
        if not self.channel.hello.compact:
            self._send_beat()
        interval_s = self.channel.hello.deadman_ms / 1000.0 / BEATS_PER_DEADMAN
        self._timer = asyncio.get_running_loop().call_later(interval_s, self._beat)

    def _send_beat(self) -> None:
        time_s = now_s()
        self._longest_pause_s = max(self._longest_pause_s, time_s - self._beat_s)
        self._beat_s = time_s
        self._beats += 1
        self.channel.send(self.channel.words.beat(self.channel.session, self._beats))

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()


def _to_state(status: Status, time_s: float, error_words: str, order: EulerOrder) -> RobotState:
    return RobotState(
        time_s=time_s,
        base_T_flange=read_pose(status.flange_xyzabc, order),
        joints_rad=np.radians(status.joints_deg),
        mode=_MODES[status.mode],
        emergency_stop=status.emergency_stop,
        drives_on=status.drives_on,
        moving=status.moving,
        stop_latched=status.latched,
        error_code=status.error_code,
        error_words=error_words,
        speed_override_ratio=status.override_percent / 100.0,
    )
