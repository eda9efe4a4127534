"""One connection of the guard to the service: blocking while it is opened, and never after."""

import contextlib
import select
import socket
from collections import deque

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost, ProtocolViolation
from drivers.robot.siasun_rpc.codec.framing import MessageReader
from drivers.robot.siasun_rpc.codec.guard_calls import answer
from drivers.robot.siasun_rpc.codec.messages import Request, Value

_CHUNK_BYTES = 4096
_READS_PER_POLL = 8
"""Most reads in one turn of the guard: a controller that floods it must not keep it from
samples."""
_MOST_WAITING = 64
"""Calls without a reply with which the controller counts as lost."""


class BlockingLine:
    """Calls go out in one piece; their answers are handed over when the last of them is there."""

    def __init__(self, label: str) -> None:
        self.waiting: deque[str] = deque()
        """Methods whose replies have not come yet."""
        self.asked_s = 0.0
        """When the newest calls were sent."""
        self._label = label
        self._socket: socket.socket | None = None
        self._reader = MessageReader()
        self._answers: list[Value] = []

    def __str__(self) -> str:
        return self._label

    def open(self, host: str, port: int, deadline_s: float) -> None:
        """Connect; an ``OSError`` when nobody is there in time."""
        self._socket = socket.create_connection((host, port), max(0.01, deadline_s - now_s()))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._reader, self.waiting, self._answers = MessageReader(), deque(), []

    def block(self, *, blocking: bool) -> None:
        """Whether reading waits."""
        if self._socket is not None:
            self._socket.setblocking(blocking)

    def close(self) -> None:
        """Drop the connection. Idempotent."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def fileno(self) -> int:
        """Descriptor of the connection, -1 while closed."""
        return -1 if self._socket is None else self._socket.fileno()

    def wait(self, deadline_s: float) -> None:
        """Wait for bytes; ``TimeoutError`` when none come."""
        left_s = deadline_s - now_s()
        if left_s <= 0.0 or not select.select([self.fileno()], [], [], left_s)[0]:
            raise TimeoutError
        # What is there may be a part of a reply, and the read must not wait for the rest.
        self.block(blocking=False)

    def send(self, *requests: Request) -> None:
        """Send calls in one piece; ``LinkLost`` when they do not fit or nobody is there."""
        if self._socket is None:
            raise LinkLost(f"{self._label} is not connected")
        data = b"".join(one.data for one in requests)
        try:
            sent = self._socket.send(data)
        except OSError as error:
            raise LinkLost(f"{self._label}: {error}") from error
        # Half a call would damage the one behind it, and a controller that has answered so few is
        # one that is not there.
        if sent < len(data) or len(self.waiting) > _MOST_WAITING:
            raise LinkLost(f"{self._label}: the controller does not answer")
        self.waiting.extend(one.method for one in requests)
        self.asked_s = now_s()

    def read(self) -> list[Value]:
        """Answers to all calls that were sent, once the last of them is there; else none."""
        if self._socket is None:
            raise LinkLost(f"{self._label} is not connected")
        # Bounded, so that a controller that floods the line cannot keep the guard from its samples.
        for _ in range(_READS_PER_POLL):
            with contextlib.suppress(BlockingIOError):
                data = self._receive(self._socket)
                if len(data) == _CHUNK_BYTES:
                    continue
            break
        if self.waiting or not self._answers:
            return []
        answers, self._answers = self._answers, []
        return answers

    def _receive(self, connection: socket.socket) -> bytes:
        try:
            data = connection.recv(_CHUNK_BYTES)
        except BlockingIOError:
            raise
        except OSError as error:
            raise LinkLost(f"{self._label}: {error}") from error
        if not data:
            raise LinkLost(f"{self._label}: closed by the controller")
        self._reader.feed(data)
        while (message := self._reader.next()) is not None:
            if not self.waiting:
                raise ProtocolViolation(f"{self._label}: a reply that nobody asked for")
            self._answers.append(answer(self.waiting.popleft(), message))
        return data
