"""The guard's one thread: wait for the sensor, the robot or the daemon; judge; stop."""

import select
import socket

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.guard.commands import Commands
from cellctl.guard.messages import Message, encode, fault_to_json, receive, trip_to_json
from cellctl.guard.monitor import Monitor
from cellctl.guard.realtime import resident_peak_bytes
from cellctl.guard.report import TripReason
from cellctl.guard.ring import RingWriter, Status
from cellctl.guard.stop_line import StopLine
from cellctl.interfaces.ft_sensor import FtSensor

_TICK_S = 2e-3
"""Longest wait while armed: bounds how late staleness is noticed."""
_LATE_S = 1e-3
"""Waking this much later than asked for means that the machine stood still."""


class GuardLoop:
    """Runs until the daemon is gone, asks for the end, or ``end`` is set. Then the robot is
    stopped, whatever it was doing.
    """

    def __init__(
        self,
        sensor: FtSensor,
        line: StopLine,
        monitor: Monitor,
        *,
        ring: RingWriter,
        link: socket.socket,
        beat_s: float,
    ) -> None:
        self.ended = False
        """Set from a signal handler to leave the loop within a beat."""
        self._sensor = sensor
        self._line = line
        self._monitor = monitor
        self._ring = ring
        self._link = link
        self._beat_s = beat_s
        self._commands = Commands(monitor, line, sensor.health)
        self._sensor_fault: CellError | None = None
        self._line_was: tuple[bool, CellError | None] = (line.up, None)
        self._told_trip = False
        self._late_wakeups = 0
        self._next_beat_s = 0.0

    def run(self) -> None:
        """The loop."""
        try:
            while not (self.ended or self._commands.quit):
                ready = self._wait()
                self._take_samples()
                if self._line.due(ready):
                    self._take_pose()
                self._tell_line()
                if self._link in ready:
                    self._take_requests()
                self._tick()
        finally:
            self._line.stop(now_s())

    def event(self, kind: str, **fields: object) -> None:
        """Tell the daemon, if it listens."""
        self._send({"event": kind, **fields})

    def _wait(self) -> list[int | socket.socket]:
        due_s = self._next_beat_s
        if self._monitor.armed:
            due_s = min(due_s, now_s() + _TICK_S)
        descriptor = self._sensor.fileno()
        waiting: list[int | socket.socket] = [*self._line.filenos(), self._link]
        if descriptor >= 0:
            waiting.append(descriptor)
        ready = select.select(waiting, [], [], max(0.0, due_s - now_s()))[0]
        late_s = now_s() - due_s
        if late_s > _LATE_S:
            self._late_wakeups += 1
            self._monitor.excuse(late_s)
        return ready

    def _take_samples(self) -> None:
        if self._sensor_fault is not None:
            return
        try:
            samples = self._sensor.read(0.0)
        except CellError as fault:
            self._sensor_fault = fault
            self._sensor.close()
            self._publish_status(now_s())  # who hears the news must not find the old status
            self._monitor.stop(TripReason.SENSOR_INVALID, now_s(), str(fault))
            self.event("sensor_fault", **fault_to_json(fault))
            return
        monitor, ring = self._monitor, self._ring
        for sample in samples:
            wrench = monitor.sample(sample)
            if monitor.trip is not None:
                self._stop()
            age_s = sample.receive_time_s - monitor.flange_time_s
            ring.publish(sample, wrench, age_s)
        monitor.sensor_health(self._sensor.health(), now_s())

    def _take_pose(self) -> None:
        state = self._line.poll(now_s())
        if state is not None:
            self._monitor.flange(state)

    def _tell_line(self) -> None:
        """News of the stop channel, whoever found out."""
        line_is = (self._line.up, self._line.fault)
        if line_is != self._line_was:
            self._line_was = line_is
            up, fault = line_is
            self._publish_status(now_s())  # who hears the news must not find the old status
            self.event("channel", up=up, fault=None if fault is None else fault_to_json(fault))
            if not up:
                self._monitor.stop(TripReason.STOP_CHANNEL_LOST, now_s(), str(fault))

    def _take_requests(self) -> None:
        while True:
            try:
                request = receive(self._link)
            except BlockingIOError:
                return
            except OSError:
                request = None
            if request is None:
                self.ended = True
                return
            answer = self._commands.answer(request, now_s())
            if answer is not None:
                self._send(answer)

    def _tick(self) -> None:
        time_s = now_s()
        monitor = self._monitor
        monitor.tick(time_s)
        if monitor.trip is not None:
            self._stop()
        elif self._told_trip:
            self._told_trip = False
        answer = self._commands.late_answer(time_s)
        if answer is not None:
            self._send(answer)
        if time_s >= self._next_beat_s:
            self._next_beat_s = max(self._next_beat_s + self._beat_s, time_s)
            self._line.beat(time_s)
            self._publish_status(time_s)

    def _stop(self) -> None:
        """Once for each trip: the request first, then the news."""
        if self._told_trip or self._monitor.trip is None:
            return
        self._line.stop(now_s())
        self._told_trip = True
        self._publish_status(now_s())
        self.event("trip", trip=trip_to_json(self._monitor.trip))

    def _publish_status(self, time_s: float) -> None:
        monitor = self._monitor
        a, b, c, d, e, f = monitor.peak_raw
        p, q, r, s, t, u = monitor.peak_filtered
        self._ring.publish_status(
            Status(
                time_s,
                int(monitor.armed),
                int(monitor.trip is not None),
                int(self._line.up),
                int(self._sensor_fault is None),
                self._late_wakeups,
                resident_peak_bytes(),
                monitor.sample_time_s,
                monitor.flange_time_s,
                self._sensor.health(),
                (a, b, c, d, e, f),
                (p, q, r, s, t, u),
            )
        )

    def _send(self, message: Message) -> None:
        """A daemon that does not read loses news, never the guard's time."""
        try:
            self._link.send(encode(message))
        except BlockingIOError:
            return
        except OSError:
            self.ended = True
