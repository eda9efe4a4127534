"""CAN messages of the box: three in order make one sample; no I/O.

A connection hands each message over as ten bytes, identifier (u16 BE) and payload, so that CAN is
one more byte stream. There is neither a counter nor a check: order is all there is to go by.
"""

import struct
from collections.abc import Sequence

from drivers.ftsensor.sri.protocol import Frame, Reply

RECORD = struct.Struct(">H8s")
_PAIR = struct.Struct("<2f")
_NUMBERS = 0x10000


class TripleDecoder:
    """Pairs the three identifiers; an incomplete triple is dropped and shows as a gap."""

    def __init__(self, data_ids: tuple[int, int, int]) -> None:
        self.checksum_errors = 0
        self.skipped_bytes = 0
        self._ids = data_ids
        self._parts: list[float] = []
        self._number = 0
        self._torn = False

    def feed(self, data: bytes) -> Sequence[Reply | Frame]:
        """Take whole records, return the samples that became complete."""
        found: list[Frame] = []
        for identifier, payload in RECORD.iter_unpack(data):
            if identifier not in self._ids:
                continue
            # With neither counter nor check, values of two samples could be joined to one that
            # never was. Only an unbroken order of the three identifiers makes a sample.
            if identifier != self._ids[len(self._parts) // 2]:
                self._tear(identifier)
                if identifier != self._ids[0]:
                    continue
            # Counted as a missing number, so that the clock and the counters see the gap as on the
            # other transports.
            if not self._parts and self._torn:
                self._torn = False
                self._count()
            self._parts += _PAIR.unpack(payload)
            if len(self._parts) == 6:
                found.append(Frame(self._number, (tuple(self._parts),)))
                self._parts.clear()
                self._count()
        return found

    def _tear(self, identifier: int) -> None:
        """Drop what has been collected of a sample, and a message that begins none."""
        messages = len(self._parts) // 2 + (identifier != self._ids[0])
        self.skipped_bytes += RECORD.size * messages
        self._parts.clear()
        self._torn = True

    def _count(self) -> None:
        self._number = (self._number + 1) % _NUMBERS
