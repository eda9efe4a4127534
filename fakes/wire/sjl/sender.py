"""The sending end of one channel of a controller, with the faults of a bad line."""

import asyncio

from fakes.faults import FaultBoard


class Sender:
    """Writes records in order; a faulty line splits, merges, dribbles, delays or spoils them."""

    def __init__(self, writer: asyncio.StreamWriter, faults: FaultBoard) -> None:
        self._writer = writer
        self._faults = faults
        self._held: list[bytes] = []
        self._queue: asyncio.Queue[bytes] = asyncio.Queue()

    def send(self, record: bytes) -> None:
        """Queue a record; it is written by ``run``."""
        self._queue.put_nowait(record)

    def close(self) -> None:
        """Close the connection; the reading end of the channel then ends too."""
        self._writer.close()

    async def run(self) -> None:
        """Write what is queued until cancelled; raises ``OSError`` when the line is gone."""
        while True:
            await self._write(await self._queue.get())

    async def _write(self, record: bytes) -> None:
        faults = self._faults
        if faults.active("silent") or faults.active("half_open"):
            return
        if faults.use("corrupt"):
            record = _spoiled(record)
        if late := faults.active("late"):
            await asyncio.sleep(late.number("delay_s", 0.3))
        if merged := faults.active("merged"):
            self._held.append(record)
            if len(self._held) < merged.number("records", 5):
                return
            record = b""
        record, self._held = b"".join(self._held) + record, []
        for piece, pause_s in self._pieces(record):
            self._writer.write(piece)
            await self._writer.drain()
            if pause_s:
                await asyncio.sleep(pause_s)

    def _pieces(self, record: bytes) -> list[tuple[bytes, float]]:
        if split := self._faults.active("split"):
            middle = len(record) // 2
            return [(record[:middle], split.number("gap_s", 0.005)), (record[middle:], 0.0)]
        if self._faults.active("dribbled"):
            return [(record[index : index + 1], 1e-4) for index in range(len(record))]
        return [(record, 0.0)]


def _spoiled(record: bytes) -> bytes:
    """The record with its last digit before the sum changed; the sum stays as it was."""
    # A digit and not any byte: the record stays well formed, and only its sum tells.
    body, star, rest = record.rpartition(b"*")
    places = [index for index, byte in enumerate(body) if chr(byte).isdigit()]
    if not places:
        return record
    last = places[-1]
    digit = b"%d" % ((int(body[last : last + 1]) + 1) % 10)
    return body[:last] + digit + body[last + 1 :] + star + rest
