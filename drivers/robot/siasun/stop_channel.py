"""The guard's GRD channel to a SIASUN robot: blocking sockets, no event loop, no arrays."""

import contextlib
import random
import socket
from typing import TypeGuard

from cellctl.clock import now_s
from cellctl.errors.link import (
    ConnectTimeout,
    LinkError,
    LinkLost,
    ProtocolViolation,
    VersionMismatch,
)
from cellctl.geometry.euler_order import EulerOrder
from cellctl.interfaces.stop_channel import FlangeState, StopChannel
from drivers.robot.siasun import faults
from drivers.robot.siasun.codec.angles import rotation_rows
from drivers.robot.siasun.codec.decoder import RecordReader
from drivers.robot.siasun.codec.handshake import HELLO_TIMEOUT_S, SESSIONS, is_robot, refusal
from drivers.robot.siasun.codec.records import Hello, Record, Status, StopDone
from drivers.robot.siasun.codec.words import words_of
from drivers.robot.siasun.config import SiasunStopChannelConfig

_CHUNK_BYTES = 4096
_READS_PER_POLL = 8
"""Most reads in one turn of the guard; see ``poll``."""
_REPEAT_S = 0.5
"""A slow interpreter that has not confirmed a stop for so long is asked again."""


class SiasunStopChannel(StopChannel):
    """Listens while ``open`` runs, for one client; afterwards further callers are refused.

    The stop request lies packed in memory before it is needed. Every request has a new number, so
    that one after a re-arm is never taken for a repetition.
    """

    Config = SiasunStopChannelConfig

    def __init__(self, config: SiasunStopChannelConfig) -> None:
        self._config = config
        self._session = random.randrange(SESSIONS)
        self._socket: socket.socket | None = None
        self._reader = RecordReader()
        self._stops = 0
        self._beats = 0
        self._words = words_of(Hello(""))
        self._order = EulerOrder.FIXED_XYZ
        self._compact = self._beat_due = False
        self._stop_record = b""
        self._asked_s: float | None = None
        """When the last stop was asked for. None again once a report has come after the standstill
        was confirmed: whoever wants a stop then wants another one."""
        self._confirmed = False
        self._asked_record = b""
        self._last: Status | None = None
        self._stranger = ""
        """Address of the last caller that is not the robot."""

    def open(self) -> None:
        """Wait for the controller's job; ``ConnectTimeout`` when it does not come."""
        self.close()
        self._stranger = ""
        host, port = self._config.listen_host, self._config.guard_port
        deadline_s = now_s() + self._config.connect_timeout_s
        try:
            listener = socket.create_server((host, port), backlog=1)
        except OSError as error:
            raise faults.cannot_listen(host, port, error) from error
        # Closed when the robot is connected: while the guard works nobody else may call.
        with listener:
            while self._socket is None:
                self._accept(listener, deadline_s)

    def close(self) -> None:
        """Drop the link. Idempotent."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def fileno(self) -> int:
        """Descriptor of the connection, -1 while closed."""
        return -1 if self._socket is None else self._socket.fileno()

    def request_stop(self) -> None:
        """Send ABORT now; a full or broken socket is ``LinkLost``."""
        # Sent first and packed for the next time afterwards: nothing is computed before a stop
        # leaves.
        self._send(self._stop_record)
        self._asked_s, self._asked_record = now_s(), self._stop_record
        self._confirmed = False
        self._pack_stop()

    def repeat_stop(self) -> None:
        """Send ABORT again, as long as the stop is not confirmed.

        A slow interpreter reads one record in each of its rounds, so what is repeated queues up
        there. It is repeated from time to time only, because heartbeats wait behind it, and with
        the same number: it may be read after the release, and must be no new stop then.
        """
        if not self._compact or self._asked_s is None:
            self.request_stop()
        elif now_s() - self._asked_s >= _REPEAT_S:
            self._send(self._asked_record)
            self._asked_s = now_s()

    def heartbeat(self) -> None:
        """Send BEAT, without which the controller's dead man stops the arm."""
        # A slow interpreter reads one record a round; heartbeats answer its reports there.
        if self._socket is not None and self._compact and not self._beat_due:
            return
        self._beat_due = False
        self._beats += 1
        self._send(self._words.beat(self._session, self._beats))

    def poll(self) -> FlangeState | None:
        """The newest report of those that arrived since the last call; None without one."""
        if self._socket is None:
            raise self._lost("not connected")
        newest: Status | None = None
        # Bounded, so that a robot that floods the channel cannot keep the guard from its samples.
        for _ in range(_READS_PER_POLL):
            try:
                data = self._socket.recv(_CHUNK_BYTES)
            except BlockingIOError:
                break
            except OSError as error:
                raise self._lost(str(error)) from error
            if not data:
                raise self._lost("closed by the robot")
            self._reader.feed(data)
            newest = self._read() or newest
        return None if newest is None else flange_state(newest, self._order, now_s())

    def _read(self) -> Status | None:
        """The newest report among the complete records; repeated ones are not news."""
        newest: Status | None = None
        try:
            while (record := self._reader.next()) is not None:
                self._beat_due = True
                if isinstance(record, StopDone):
                    self._confirmed = True
                elif self._confirmed:
                    self._asked_s = None
                if _is_news(record, self._last):
                    newest = self._last = record
        except ProtocolViolation:
            self.close()
            raise
        return newest

    def _accept(self, listener: socket.socket, deadline_s: float) -> None:
        """Serve one caller. A caller that does not speak the protocol is sent away."""
        listener.settimeout(self._left_s(deadline_s))
        with contextlib.suppress(TimeoutError):
            client, caller = listener.accept()
            if not is_robot(caller[0], self._config.robot_address):
                client.close()
                self._stranger = caller[0]
                return
            try:
                self._greet(client, min(deadline_s, now_s() + HELLO_TIMEOUT_S))
            # Raised and not passed over: a robot with a wrong job program calls again and again,
            # and only a person can change that.
            except VersionMismatch:
                client.close()
                raise
            except (LinkError, OSError):
                client.close()

    def _greet(self, client: socket.socket, deadline_s: float) -> None:
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        reader = RecordReader()
        while (hello := reader.next()) is None:
            client.settimeout(self._left_s(deadline_s))
            data = client.recv(_CHUNK_BYTES)
            if not data:
                raise self._lost("closed by the robot")
            reader.feed(data)
        if not isinstance(hello, Hello):
            raise ProtocolViolation(f"{type(hello).__name__} before HELLO")
        config = self._config
        refused = refusal(hello, "GRD", config.robot_name, config.max_deadman_s)
        if refused is not None:
            word, facts = refused
            client.sendall(words_of(hello).refuse_hello(word))
            raise VersionMismatch(f"{config.robot_name} GRD: {facts}")
        self._session = self._session % SESSIONS + 1
        self._words, self._compact, self._beat_due = words_of(hello), hello.compact, False
        self._order = hello.euler_order
        client.sendall(self._words.accept_hello(self._session))
        # From here on the guard's loop owns it, and nothing may block there.
        client.settimeout(0.0)
        self._socket, self._reader, self._last = client, reader, None
        self._stops = self._beats = 0
        self._asked_s = None
        self._pack_stop()

    def _pack_stop(self) -> None:
        self._stops += 1
        self._stop_record = self._words.abort(self._session, self._stops)

    def _send(self, record: bytes) -> None:
        if self._socket is None:
            raise self._lost("not connected")
        try:
            sent = self._socket.send(record)
        except OSError as error:
            raise self._lost(str(error)) from error
        # A robot that reads nothing has filled the socket. Half a record would also damage the one
        # behind it.
        if sent < len(record):
            raise self._lost("the robot does not read")

    def _left_s(self, deadline_s: float) -> float:
        left_s = deadline_s - now_s()
        if left_s <= 0.0:
            name, timeout_s = self._config.robot_name, self._config.connect_timeout_s
            trace = f"; refused: {self._stranger}" if self._stranger else ""
            raise ConnectTimeout(f"{name} GRD did not connect within {timeout_s:g} s{trace}")
        return left_s

    def _lost(self, facts: str) -> LinkLost:
        self.close()
        return LinkLost(f"{self._config.robot_name} GRD: {facts}")


def _is_news(record: Record, last: Status | None) -> TypeGuard[Status]:
    """A report that moves on from the last one. STOPD says nothing that reports do not say."""
    if isinstance(record, StopDone):
        return False
    if not isinstance(record, Status):
        raise ProtocolViolation(f"{type(record).__name__} on GRD")
    return last is None or record.follows(last)


def flange_state(status: Status, order: EulerOrder, time_s: float) -> FlangeState:
    """A report that came at ``time_s``, of a controller with this order of angles, in SI."""
    x_mm, y_mm, z_mm, a_deg, b_deg, c_deg = status.flange_xyzabc
    return FlangeState(
        time_s,
        (x_mm / 1000.0, y_mm / 1000.0, z_mm / 1000.0),
        rotation_rows(order, a_deg, b_deg, c_deg),
        status.moving,
        status.latched,
    )
