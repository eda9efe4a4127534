"""The daemon's end of the shared memory: the newest sample, stretches of samples, the status."""

from bisect import bisect_right

import numpy as np

from cellctl.guard import ring
from cellctl.guard.report import GuardSample, GuardSamples

_SLOT = np.dtype(
    [
        ("index", "u8"),
        ("time_s", "f8"),
        ("receive_time_s", "f8"),
        ("flange_age_s", "f8"),
        ("number", "u8"),
        ("wrench", "f8", (6,)),
        ("raw", "f8", (6,)),
    ]
)
_STATUS_TRIES = 1000
"""Reading a status takes longer than writing one, so a live writer lets far fewer tries fail."""


class RingReader:
    """Reads samples and status without making the writer wait."""

    def __init__(self, descriptor: int) -> None:
        self._memory, self._slots = ring.attach(descriptor)
        self._words = np.frombuffer(self._memory, "u8", ring.HEADER_BYTES // 8)
        self._ring = np.frombuffer(self._memory, _SLOT, self._slots, ring.HEADER_BYTES)

    def close(self) -> None:
        """Unmap the memory. All that was handed out are copies, so nobody still refers to it."""
        del self._words, self._ring
        self._memory.close()

    def latest(self) -> GuardSample | None:
        """The newest sample; None before the first."""
        while (head := self._head()) > 0:
            slot = self._ring[(head - 1) % self._slots].copy()
            # The writer may have gone round the ring while this was copied: then try again.
            if self._head() - head < self._slots - 1 and slot["index"] == head - 1:
                return GuardSample(
                    time_s=float(slot["time_s"]),
                    receive_time_s=float(slot["receive_time_s"]),
                    number=int(slot["number"]),
                    wrench=slot["wrench"].copy(),
                    raw=slot["raw"].copy(),
                    flange_age_s=float(slot["flange_age_s"]),
                )
        return None

    def since(self, since_s: float) -> GuardSamples:
        """All samples with a time after ``since_s``."""
        head = self._head()
        # The slot behind the head is the one that the writer fills next, so it may change at any
        # moment: one slot less than the ring has can be read.
        oldest = max(0, head - self._slots + 1)
        first = self._first_after(since_s, oldest, head)
        begin, end = first % self._slots, head % self._slots
        if first == head:
            found = self._ring[:0].copy()
        elif begin < end:
            found = self._ring[begin:end].copy()
        else:
            found = np.concatenate([self._ring[begin:], self._ring[:end]])
        # Whatever the writer has reached since the head was read may be half old, half new.
        intact = found["index"] == np.arange(first, head, dtype="u8")
        intact &= found["index"] >= max(0, self._head() - self._slots + 1)
        kept = found[intact]
        # A stretch that begins with the oldest sample left may have begun before it.
        overrun = len(kept) < len(found) or (first == oldest and oldest > 0)
        return GuardSamples(
            time_s=kept["time_s"].copy(),
            wrench=kept["wrench"].copy(),
            raw=kept["raw"].copy(),
            flange_age_s=kept["flange_age_s"].copy(),
            overrun=overrun,
        )

    def status(self) -> ring.GuardStatus | None:
        """The status of the last beat; None when its writer stopped in the middle of one."""
        for _ in range(_STATUS_TRIES):
            before = int(self._words[ring.STATUS_NUMBER])
            status = ring.GuardStatus.unpack_from(self._memory)
            if before % 2 == 0 and int(self._words[ring.STATUS_NUMBER]) == before:
                return status if before else ring.GuardStatus()
        return None

    def _head(self) -> int:
        return int(self._words[ring.HEAD])

    def _first_after(self, since_s: float, low: int, high: int) -> int:
        """Index of the first sample after a time."""
        # Times rise with the index. Bisection looks at some seventeen slots; comparing all times
        # would copy a megabyte of the ring at every look.
        return bisect_right(
            range(high), since_s, low, key=lambda index: self._ring[index % self._slots]["time_s"]
        )
