"""The fake box on CAN: a command byte in, three messages of two floats a sample out.

The layout is that of the M8123B2 as one public project reads it, and has not been compared with a
device: command id 0x80 with 02 start, 01 one sample, 00 stop; replies 0x291 Fx Fy, 0x292 Fz Mx,
0x293 My Mz as little-endian float32. There is neither a number nor a check.
"""

import struct
from typing import NamedTuple

from fakes.wire.sri.core import SriCore
from fakes.wire.sri.settings import DataFormat

COMMAND_ID = 0x80
REPLY_IDS = (0x291, 0x292, 0x293)
STOP, SINGLE, START = 0, 1, 2
_BUS_LIMIT_HZ = 2500.0
"""What 1 Mbit/s lets through: a sample is three messages, of up to 135 bits each with stuffing."""
_CATCH_UP_S = 1.0
"""A box whose messages nobody could take for longer than this has dropped them."""


class CanFrame(NamedTuple):
    """A classic CAN message with an 11-bit id."""

    id: int
    data: bytes


class CanSession:
    """State of the stream on one bus, without I/O."""

    def __init__(self, core: SriCore) -> None:
        self._core = core
        self._next_s: float | None = None
        self._samples = 0
        self._waiting: list[CanFrame] = []

    @property
    def due_s(self) -> float | None:
        """When to send next."""
        if self._waiting:
            return 0.0
        return None if self._next_s is None else self._next_s + self._core.faults.late_s

    def connected(self, now_s: float) -> None:
        """The bus is up."""
        if self._core.faults.stale_stream:
            self._next_s = now_s

    def receive(self, frame: CanFrame, now_s: float) -> None:
        """Take a message from the bus; others than one-byte commands are not for the box."""
        if frame.id != COMMAND_ID or len(frame.data) != 1 or self._core.faults.half_open:
            return
        command = frame.data[0]
        if command == START:
            self._next_s = now_s + self._period_s()
        elif command == STOP:
            self._next_s = None
        elif command == SINGLE:
            self._waiting += self._sample(now_s)

    def emit(self, now_s: float) -> list[CanFrame]:
        """Messages that are due by now."""
        frames, self._waiting = self._waiting, []
        while self._next_s is not None and self._next_s + self._core.faults.late_s <= now_s:
            time_s = max(self._next_s, now_s - self._core.faults.late_s - _CATCH_UP_S)
            self._next_s = time_s + self._period_s()
            frames += self._sample(time_s)
        return frames

    def _period_s(self) -> float:
        return 1.0 / min(self._core.settings.rate_hz, _BUS_LIMIT_HZ)

    def _sample(self, time_s: float) -> list[CanFrame]:
        faults = self._core.faults
        values = self._core.point(time_s, DataFormat())
        data = b"\xff" * 24 if faults.nan else struct.pack("<6f", *values)
        frames = [CanFrame(id_, data[8 * k : 8 * k + 8]) for k, id_ in enumerate(REPLY_IDS)]
        self._samples += 1
        if faults.half_open or faults.silent:
            return []
        if faults.skip_every and self._samples % faults.skip_every == 0:
            del frames[self._samples // faults.skip_every % 3]
        return frames
