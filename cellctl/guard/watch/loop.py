"""The guard's one thread: wait for sensor, robot or daemon; judge each sample; stop the robot.

Why one thread and ``select``: with everything in one thread there are no locks to wait for, and
between the arrival of a sample and the stop request lies nothing but the judgement itself. An event
loop would put its own scheduling in between (docs/decisions/0003).

Each turn takes samples first, because only they can ask for a stop that cannot wait. The robot's
reports come second, since the next sample needs the newest flange pose. Requests of the daemon come
last: whatever the daemon asks, and however often, a sample waits for one turn at most.
"""

import select
import socket

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.guard.messages import Message, encode, fault_to_json, receive, trip_to_json
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.guard.ring import GuardStatus, RingWriter
from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.guard.watch.realtime import resident_peak_bytes
from cellctl.guard.watch.request_handler import RequestHandler
from cellctl.guard.watch.stop_supervisor import StopSupervisor
from cellctl.interfaces.ft_sensor import FtSensor

_TICK_S = 2e-3
"""Longest wait while armed. Nothing arrives when a sensor falls silent, so the loop has to wake up
by itself to notice; this bounds how late it does."""
_LATE_S = 1e-3
"""Waking this much later than asked for means that the machine stood still. An idle Linux wakes a
process within a tenth of it."""


class GuardLoop:
    """Runs until the daemon is gone, asks for the end, or ``ended`` is set.

    Whatever ends it, a defect included, the robot is stopped first.
    """

    def __init__(
        self,
        sensor: FtSensor,
        supervisor: StopSupervisor,
        monitor: WrenchMonitor,
        *,
        ring: RingWriter,
        link: socket.socket,
        beat_s: float,
    ) -> None:
        self.ended = False
        """Set it from a signal handler to leave the loop within one beat."""
        self._sensor = sensor
        self._supervisor = supervisor
        self._monitor = monitor
        self._ring = ring
        self._link = link
        self._beat_s = beat_s
        self._requests = RequestHandler(monitor, supervisor, sensor.health)
        self._sensor_fault: CellError | None = None
        # What is true at the beginning is not told, so the first event is the end of the first
        # attempt to connect, for which ``GuardClient.start`` waits.
        self._reported_channel: tuple[bool, CellError | None] = (supervisor.up, None)
        self._handled_trip: GuardTrip | None = None
        """The trip for which a stop was requested last."""
        self._late_wakeups = 0
        self._next_beat_s = 0.0

    def run(self) -> None:
        """Guard until the daemon asks for the end, is gone, or ``ended`` is set."""
        try:
            while not (self.ended or self._requests.quit):
                ready = self._wait()
                self._take_samples()
                if self._supervisor.due(ready):
                    self._take_pose()
                self._report_channel()
                if self._link in ready:
                    self._take_requests()
                self._tick()
        finally:
            # Nobody watches the force from here on, so the robot must not go on moving.
            self._supervisor.stop(now_s())

    def event(self, kind: str, **fields: object) -> None:
        """Send an event to the daemon, if it listens."""
        self._send({"event": kind, **fields})

    def _wait(self) -> list[int | socket.socket]:
        """Wait for input until the next beat or tick is due; the descriptors that are readable.

        ``select`` returns early when something arrives, so a late return means that nobody let
        this process run: the machine stood still, on a virtual machine often for tens of
        milliseconds. Sensor and robot may have sent on time and the data may lie in the socket.
        That time must not count as their silence, or every pause of the machine would stop the
        robot. It is excused by its length, so a sensor that is silent too is still caught, and by
        ``MOST_EXCUSED_S`` at most, however long or often the machine pauses.
        """
        due_s = self._next_beat_s
        # Not armed, silence is no trip, so there is no reason to wake up five hundred times a
        # second.
        if self._monitor.armed:
            due_s = min(due_s, now_s() + _TICK_S)
        waiting: list[int | socket.socket] = [*self._supervisor.filenos(), self._link]
        descriptor = self._sensor.fileno()
        if descriptor >= 0:  # a driver that is reconnecting has none
            waiting.append(descriptor)
        ready = select.select(waiting, [], [], max(0.0, due_s - now_s()))[0]
        late_s = now_s() - due_s
        if late_s > _LATE_S:
            self._late_wakeups += 1
            self._monitor.excuse(late_s)
        return ready

    def _take_samples(self) -> None:
        """Judge what the sensor has sent.

        The sensor is read in every turn, readable or not: its driver also reconnects in ``read``,
        and then there is no descriptor that could become readable.
        """
        if self._sensor_fault is not None:
            return
        try:
            # No time-out: waiting is the business of ``select``, which also watches robot and
            # daemon.
            samples = self._sensor.read(0.0)
        except CellError as fault:
            self._give_up_sensor(fault)
            return
        monitor, ring = self._monitor, self._ring
        for sample in samples:
            wrench = monitor.sample(sample)
            # The stop comes before the sample is published: publishing can wait, a stop cannot.
            self._stop_at_new_trip()
            age_s = sample.receive_time_s - monitor.flange_time_s
            ring.publish(sample, wrench, age_s)
        # After the samples of the same read, so that a touch among them is reported as the touch
        # and not as the damaged frame that came with it.
        monitor.sensor_health(self._sensor.health(), now_s())

    def _give_up_sensor(self, fault: CellError) -> None:
        """Use this sensor no more.

        A driver rides out a lost link by itself. What it raises is final, for instance a box that
        came back with another set-up, whose values would mean something else. The process lives
        on, so that the robot keeps its heartbeat and can be moved; nothing can be armed.
        """
        self._sensor_fault = fault
        self._sensor.close()
        # The status goes first: a daemon that reacts to the event must not find the old one.
        self._publish_status(now_s())
        self._monitor.stop(TripReason.SENSOR_INVALID, now_s(), str(fault))
        self.event("sensor_fault", **fault_to_json(fault))

    def _take_pose(self) -> None:
        state = self._supervisor.poll(now_s())
        if state is not None:
            self._monitor.flange(state)

    def _report_channel(self) -> None:
        """Tell the daemon when the stop channel has gone up or down, and trip when it is down.

        The channel can be found broken by a poll, by a beat or by a stop request. Comparing with
        what was told last covers all of them in one place.
        """
        channel = (self._supervisor.up, self._supervisor.fault)
        if channel == self._reported_channel:
            return
        self._reported_channel = channel
        up, fault = channel
        # The status goes first: a daemon that reacts to the event must not find the old one.
        self._publish_status(now_s())
        self.event("channel", up=up, fault=None if fault is None else fault_to_json(fault))
        if not up:
            self._monitor.stop(TripReason.STOP_CHANNEL_LOST, now_s(), str(fault))

    def _take_requests(self) -> None:
        """Answer all requests that wait; the end of the link is the end of the daemon."""
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
            answer = self._requests.answer(request, now_s())
            if answer is not None:
                self._send(answer)

    def _tick(self) -> None:
        """What depends on the time and not on input: silence, late answers, the beat."""
        time_s = now_s()
        self._monitor.tick(time_s)
        self._stop_at_new_trip()
        answer = self._requests.late_answer(time_s)
        if answer is not None:
            self._send(answer)
        if time_s >= self._next_beat_s:
            # Beats keep their pace. After a pause of the machine the missed ones are skipped:
            # a burst of beats would tell the robot nothing.
            self._next_beat_s = max(self._next_beat_s + self._beat_s, time_s)
            self._supervisor.beat(time_s)
            self._publish_status(time_s)

    def _stop_at_new_trip(self) -> None:
        """Handle a new trip, once: request the stop, then publish and tell.

        The order is what the guard is for: until the request is on the wire nothing else is done.
        Repeating a request that the robot has not confirmed is the supervisor's work.
        """
        trip = self._monitor.trip
        # Told apart by identity and not by a flag that is cleared once no trip is latched: an
        # acknowledgement and the next arming may both be read in one turn, and a trip of that
        # arming would then be taken for the one before.
        if trip is None or trip is self._handled_trip:
            return
        self._supervisor.stop(now_s())
        self._handled_trip = trip
        self._publish_status(now_s())
        self.event("trip", trip=trip_to_json(trip))

    def _publish_status(self, time_s: float) -> None:
        monitor = self._monitor
        # Written out because a tuple made of a list has no fixed length for the type checker.
        a, b, c, d, e, f = monitor.peak_raw
        p, q, r, s, t, u = monitor.peak_filtered
        self._ring.publish_status(
            GuardStatus(
                time_s=time_s,
                armed=int(monitor.armed),
                latched=int(monitor.trip is not None),
                channel_up=int(self._supervisor.up),
                sensor_open=int(self._sensor_fault is None),
                late_wakeups=self._late_wakeups,
                resident_peak_bytes=resident_peak_bytes(),
                sample_time_s=monitor.sample_time_s,
                flange_time_s=monitor.flange_time_s,
                sensor=self._sensor.health(),
                peak_raw=(a, b, c, d, e, f),
                peak_filtered=(p, q, r, s, t, u),
            )
        )

    def _send(self, message: Message) -> None:
        """Send without waiting.

        A daemon that does not read loses events; waiting for it would delay the next sample. The
        shared status tells it the same facts later.
        """
        try:
            self._link.send(encode(message))
        except BlockingIOError:
            return
        except OSError:
            self.ended = True
