"""The box over RS232 or a USB adapter."""

import contextlib
import select
import termios

import serial

from drivers.ftsensor.sri import faults
from drivers.ftsensor.sri.connection import Connection

_CHUNK_BYTES = 4096


class SerialConnection(Connection):
    """8N1 without flow control, read without waiting."""

    def __init__(self, device: str, baud: int) -> None:
        self.peer = device
        self._baud = baud
        self._port: serial.Serial | None = None

    def connect(self) -> None:
        """Open the device for this process alone."""
        self.close()
        try:
            self._port = serial.Serial(
                # Exclusive: a terminal program left open on the line would take half of the bytes.
                self.peer,
                self._baud,
                timeout=0,
                write_timeout=0.5,
                exclusive=True,
            )
        # An adapter that is pulled out while it is opened shows in any of these ways.
        except (OSError, ValueError, termios.error) as error:
            raise faults.cannot_connect(self.peer, error) from error
        # FTDI adapters gather for 16 ms unless told not to; ptys and others know no such setting.
        with contextlib.suppress(OSError, ValueError, serial.SerialException):
            self._port.set_low_latency_mode(True)

    def established(self) -> bool:
        """A serial line has no handshake."""
        return self._port is not None

    def close(self) -> None:
        """Close the device."""
        if self._port is not None:
            with contextlib.suppress(OSError, serial.SerialException):
                self._port.close()
        self._port = None

    def fileno(self) -> int:
        """Descriptor of the device."""
        return -1 if self._port is None else int(self._port.fileno())

    def wait(self, timeout_s: float) -> None:
        """Wait for bytes."""
        select.select([] if self._port is None else [self._port], [], [], timeout_s)

    def send(self, data: bytes) -> None:
        """Write the command."""
        if self._port is None:
            raise faults.lost(self.peer, "not connected")
        try:
            self._port.write(data)
        except (OSError, serial.SerialException) as error:
            self.close()
            raise faults.lost(self.peer, error) from error

    def receive(self) -> bytes:
        """What has arrived."""
        if self._port is None:
            raise faults.lost(self.peer, "not connected")
        try:
            return bytes(self._port.read(_CHUNK_BYTES))
        except (OSError, serial.SerialException) as error:
            self.close()
            raise faults.lost(self.peer, error) from error
