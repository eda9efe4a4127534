"""The box over CAN, on any interface of python-can."""

import contextlib
import os
import select
from collections import deque

import can

from drivers.ftsensor.sri import faults
from drivers.ftsensor.sri.can_frames import RECORD
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.connection import Connection

_DATA_BYTES = 8


class CanConnection(Connection):
    """Each ``send`` is one command message, each received message one record of ten bytes.

    Interfaces without a descriptor are read by python-can's own thread, which signals an eventfd.
    """

    def __init__(self, config: SriConfig) -> None:
        self.peer = f"{config.can_interface}:{config.can_channel}"
        self._config = config
        self._bus: can.BusABC | None = None
        self._notifier: can.Notifier | None = None
        # Bounded: should nobody read, the oldest messages are lost, and the sequence shows the gap.
        self._waiting: deque[bytes] = deque(maxlen=65_536)
        self._bell = -1

    def connect(self) -> None:
        """Open the bus with a filter for the three identifiers."""
        self.close()
        config = self._config
        try:
            self._bus = can.Bus(
                interface=config.can_interface,
                channel=config.can_channel,
                can_filters=[
                    # Filtered by the interface: on a bus with other devices their messages would
                    # each wake the guard.
                    {"can_id": number, "can_mask": 0x7FF, "extended": False}
                    for number in config.can_data_ids
                ],
                **config.can_options,
            )
        except (can.CanError, OSError, ValueError, ImportError) as error:
            raise faults.cannot_connect(self.peer, error) from error
        try:
            # The guard waits in ``select`` for all of its links at once, so every link must have a
            # descriptor.
            self._bus.fileno()
        except NotImplementedError:
            self._bell = os.eventfd(0, os.EFD_NONBLOCK)
            self._notifier = can.Notifier(self._bus, [self._ring], timeout=0.1)

    def established(self) -> bool:
        """A bus has no handshake."""
        return self._bus is not None

    def close(self) -> None:
        """Leave the bus."""
        if self._notifier is not None:
            # The thread first, because it reads from the bus that is closed next.
            self._notifier.stop()
        if self._bus is not None:
            with contextlib.suppress(can.CanError, OSError):
                self._bus.shutdown()
        if self._bell >= 0:
            os.close(self._bell)
        self._bus, self._notifier, self._bell = None, None, -1
        self._waiting.clear()

    def fileno(self) -> int:
        """Descriptor of the bus, or of the bell in its place."""
        if self._bus is None or self._bell >= 0:
            return self._bell
        return int(self._bus.fileno())

    def wait(self, timeout_s: float) -> None:
        """Wait for a message."""
        descriptor = self.fileno()
        select.select([] if descriptor < 0 else [descriptor], [], [], timeout_s)

    def send(self, data: bytes) -> None:
        """Send the command message."""
        if self._bus is None:
            raise faults.lost(self.peer, "not connected")
        message = can.Message(
            arbitration_id=self._config.can_command_id, data=data, is_extended_id=False
        )
        try:
            self._bus.send(message, timeout=0.5)
        except (can.CanError, OSError) as error:
            self.close()
            raise faults.lost(self.peer, error) from error

    def receive(self) -> bytes:
        """All messages that wait, each as a record of ten bytes."""
        if self._bus is None:
            raise faults.lost(self.peer, "not connected")
        try:
            return b"".join(self._rung() if self._bell >= 0 else self._polled(self._bus))
        except (can.CanError, OSError) as error:
            self.close()
            raise faults.lost(self.peer, error) from error

    def _rung(self) -> list[bytes]:
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self._bell)
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

    def _polled(self, bus: can.BusABC) -> list[bytes]:
        found: list[bytes] = []
        # All that wait, because one wake-up may stand for several messages.
        while (message := bus.recv(0.0)) is not None:
            found += _record(message)
        return found

    def _ring(self, message: can.Message) -> None:
        self._waiting.extend(_record(message))
        os.eventfd_write(self._bell, 1)


def _record(message: can.Message) -> list[bytes]:
    """The message as a record; error, remote and short messages are no data."""
    if message.is_error_frame or message.is_remote_frame or len(message.data) != _DATA_BYTES:
        return []
    return [RECORD.pack(message.arbitration_id, bytes(message.data))]
