"""Shared memory between guard and daemon: a ring of samples and a block of status.

Why shared memory: a socket would fill up while the daemon is busy, and then the guard would have to
wait or to drop samples. Here one process writes, any number read, and nobody ever waits.

The memory is an anonymous file whose descriptor the guard inherits. It has no name, so nothing is
left behind whoever is killed.

Consistency without locks: a sample is written completely before the head counts it. A reader
copies, then looks at the head again: slots that the writer may have reached meanwhile are an
overrun. The status is bracketed by a number that is odd while the status changes. Both rely on
stores becoming visible in program order, as on x86-64; the index inside each slot catches what a
processor with weaker rules would get wrong.
"""

import mmap
import os
import struct
from typing import NamedTuple

from cellctl.guard.limits import Six
from cellctl.interfaces.ft_sensor import FtHealth, WrenchSample

MAGIC = 0x4755_4152_4431
"""``GUARD1`` in ASCII, the first word of the header; the second is the number of slots."""
HEADER_BYTES = 4096
"""One page, so that the slots begin at a page too."""
HEAD, STATUS_NUMBER = 8, 16
"""Index of these 64-bit words in the header: bytes 64 and 128, each in a cache line of its own."""
STATUS_OFFSET = 256
"""Byte at which the status begins."""

SLOT = struct.Struct("=Q3dQ12d")
"""Index, sample time, receive time, flange age, packet number, wrench (6), raw (6)."""
_STATUS = struct.Struct("=d6Q2d8Qd12d")
"""The fields of ``GuardStatus`` in their order: time, six counts, two times, the driver's eight
counters and its rate, twelve peaks. The leading ``=`` in both layouts means no padding, so that
``RingReader`` can name the same bytes as an array."""


class GuardStatus(NamedTuple):
    """What the guard publishes about itself at every beat. Times are monotonic, in seconds."""

    time_s: float = 0.0
    armed: int = 0
    latched: int = 0
    channel_up: int = 0
    sensor_open: int = 0
    late_wakeups: int = 0
    resident_peak_bytes: int = 0
    sample_time_s: float = float("-inf")
    flange_time_s: float = float("-inf")
    sensor: FtHealth = FtHealth()
    peak_raw: Six = (0.0,) * 6
    peak_filtered: Six = (0.0,) * 6

    def pack_into(self, memory: mmap.mmap) -> None:
        """Write all fields; the caller brackets this with the status number."""
        sensor = self.sensor
        _STATUS.pack_into(
            memory,
            STATUS_OFFSET,
            *self[:9],
            *(sensor.samples, sensor.lost, sensor.checksum_errors, sensor.resynchronised_bytes),
            *(sensor.invalid, sensor.saturated, sensor.reconnects, sensor.rate_deviations),
            sensor.rate_hz,
            *self.peak_raw,
            *self.peak_filtered,
        )

    @classmethod
    def unpack_from(cls, memory: mmap.mmap) -> "GuardStatus":
        """Read all fields; may be torn unless the status number says otherwise."""
        values = _STATUS.unpack_from(memory, STATUS_OFFSET)
        numbers, sensor, peaks = values[:9], values[9:18], values[18:]
        return cls._make([*numbers, FtHealth(*sensor), peaks[:6], peaks[6:]])


def create(slots: int) -> int:
    """Descriptor of a new, empty ring. ``slots`` is a power of two."""
    if slots < 2 or slots & (slots - 1):
        raise ValueError(f"{slots} slots are not a power of two")
    descriptor = os.memfd_create("cellctl-guard")
    os.ftruncate(descriptor, HEADER_BYTES + slots * SLOT.size)
    with mmap.mmap(descriptor, HEADER_BYTES) as memory:
        struct.pack_into("=QQ", memory, 0, MAGIC, slots)
    return descriptor


def attach(descriptor: int) -> tuple[mmap.mmap, int]:
    """Map a ring; the memory and the number of its slots."""
    memory = mmap.mmap(descriptor, 0)
    magic, slots = struct.unpack_from("=QQ", memory, 0)
    if magic != MAGIC or len(memory) != HEADER_BYTES + slots * SLOT.size:
        raise ValueError("this memory is no ring of the guard")
    return memory, slots


class RingWriter:
    """The guard's end of the shared memory; uses no arrays."""

    def __init__(self, descriptor: int) -> None:
        self._memory, slots = attach(descriptor)
        # A view of whole words: one assignment to it is one store of 64 bits, so a reader in the
        # other process never sees half of a number.
        self._words = memoryview(self._memory)[:HEADER_BYTES].cast("Q")
        self._mask = slots - 1  # slots are a power of two, so this replaces a division
        self._head = 0
        self._status_number = 0

    def publish(self, sample: WrenchSample, wrench: Six, flange_age_s: float) -> None:
        """Write one sample with its contact wrench in the wrench frame, then count it."""
        head = self._head
        offset = HEADER_BYTES + (head & self._mask) * SLOT.size
        receive_s, time_s, number, *raw, _ = sample
        SLOT.pack_into(
            self._memory, offset, head, time_s, receive_s, flange_age_s, number, *wrench, *raw
        )
        self._head = head + 1
        self._words[HEAD] = head + 1

    def publish_status(self, status: GuardStatus) -> None:
        """Replace the status."""
        # Odd from here on: a reader that looks in between tries again.
        self._words[STATUS_NUMBER] = self._status_number + 1
        status.pack_into(self._memory)
        self._status_number += 2
        self._words[STATUS_NUMBER] = self._status_number

    def close(self) -> None:
        """Unmap the memory."""
        self._words.release()
        self._memory.close()
