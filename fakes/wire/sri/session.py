"""One byte link to the fake box, without I/O: AT lines in, replies and paced frames out."""

from collections.abc import Iterator

from fakes.wire.sri.core import SriCore
from fakes.wire.sri.frames import frame_length
from fakes.wire.sri.settings import DataFormat

_LONGEST_LINE = 1024
"""Bytes without an end of line after which they are dropped. The longest command, which sets the
matrix, takes about 400."""
_CATCH_UP_S = 1.0
"""A box whose frames nobody could take for longer than this has dropped them."""


class SriSession:
    """State of one TCP client or of the serial line. Times come from the caller."""

    def __init__(self, core: SriCore, max_bytes_per_s: float | None = None) -> None:
        self._core = core
        self._max_bytes_per_s = max_bytes_per_s
        self._line = bytearray()
        self._format: DataFormat | None = None
        self._next_s: float | None = None
        self._frames = 0
        self._tail = b""
        self._gathered: list[bytes] = []

    @property
    def due_s(self) -> float | None:
        """When the next frame is to be sent; None while no stream runs."""
        return None if self._next_s is None else self._next_s + self._core.faults.late_s

    def connected(self, now_s: float) -> None:
        """A client has come."""
        if self._core.faults.stale_stream:
            self._start(None, now_s)

    def receive(self, data: bytes, now_s: float) -> bytes:
        """Take bytes from the client, return what the box answers to them."""
        if self._core.faults.half_open:
            return b""
        self._line += data
        replies = b""
        while (end := self._line.find(b"\n")) >= 0:
            line = bytes(self._line[:end]).strip()
            del self._line[: end + 1]
            replies += self._execute(line.decode("ascii", "replace"), now_s)
        if len(self._line) > _LONGEST_LINE:
            self._line.clear()
        return replies

    def emit(self, now_s: float) -> list[bytes]:
        """Writes that are due by now, oldest first."""
        writes: list[bytes] = []
        while (due_s := self.due_s) is not None and due_s <= now_s:
            time_s = self._advance(now_s)
            frame = self._core.frame(self._times(time_s), self._format)
            self._frames += 1
            if not (self._core.faults.half_open or self._core.faults.silent):
                writes.extend(self._deliver(frame))
        return writes

    def _advance(self, now_s: float) -> float:
        """Take the due time off the schedule; after a long stall forget the backlog."""
        period_s = self._period_s()
        time_s = self._next_s if self._next_s is not None else now_s
        if now_s - time_s > _CATCH_UP_S + self._core.faults.late_s:
            missed = int((now_s - time_s) / period_s)
            self._core.next_number = (self._core.next_number + missed) & 0xFFFF
            time_s += missed * period_s
        self._next_s = time_s + period_s
        return time_s

    def _period_s(self) -> float:
        settings = self._core.settings
        chosen = self._format or settings.data_format
        period_s = chosen.points / settings.rate_hz
        if self._max_bytes_per_s is None:
            return period_s
        size = frame_length(len(chosen.channels), chosen.points, chosen.unit, settings.check)
        return max(period_s, size / self._max_bytes_per_s)

    def _times(self, last_s: float) -> list[float]:
        chosen = self._format or self._core.settings.data_format
        step_s = 1.0 / self._core.settings.rate_hz
        return [last_s - step_s * back for back in reversed(range(chosen.points))]

    def _deliver(self, frame: bytes) -> Iterator[bytes]:
        """The frame with the link faults applied, as separate writes."""
        faults = self._core.faults
        if _hits(self._frames, faults.skip_every):
            return
        if _hits(self._frames, faults.corrupt_every):
            frame = frame[:9] + bytes([frame[9] ^ 0x10]) + frame[10:]
        if _hits(self._frames, faults.ack_in_stream_every):
            frame += b"ACK+SMPF=200$OK\r\n"
        self._gathered.append(self._tail + frame)
        self._tail = b""
        if len(self._gathered) < faults.coalesce:
            return
        whole = b"".join(self._gathered)
        self._gathered.clear()
        if faults.split:
            cut = 1 + self._frames % (len(frame) - 1)
            whole, self._tail = whole[:-cut], whole[-cut:]
        yield whole

    def _execute(self, line: str, now_s: float) -> bytes:
        """One command line; commands that start or give data have no ACK."""
        if not line.startswith("AT+"):
            return b""
        name, _, value = line[3:].partition("=")
        try:
            if name in ("GSD", "GETSD", "GOD"):
                return self._data_command(name, value, now_s)
            text = self._parameter(name, value, now_s)
        except ValueError:
            return f"ACK+{name}=$ERROR\r\n".encode("ascii", "replace")
        return f"ACK+{name}={text}$OK\r\n".encode("ascii", "replace")

    def _parameter(self, name: str, value: str, now_s: float) -> str:
        """Read, write or act on a parameter; the value text of the ACK."""
        if self._core.faults.no_smpf and name == "SMPF":
            raise ValueError(name)
        if name == "ADJZF":
            return self._core.adjust_zero(value, now_s)
        if value == "?":
            return self._core.settings.query(name)
        return self._core.settings.write(name, value)

    def _data_command(self, name: str, value: str, now_s: float) -> bytes:
        if value == "STOP" and name != "GOD":
            rest = b"".join(self._gathered) + self._tail
            self._gathered.clear()
            self._next_s, self._tail = None, b""
            return rest + f"ACK+{name}=STOP$OK\r\n".encode()
        data_format = DataFormat.parse(value) if value else None
        if name != "GOD":
            self._start(data_format, now_s)
            return b""
        self._format = data_format
        previous_s = now_s - 1.0 / self._core.settings.rate_hz
        return self._core.frame(self._times(previous_s), data_format)

    def _start(self, data_format: DataFormat | None, now_s: float) -> None:
        self._format = data_format
        self._next_s = now_s + self._period_s()


def _hits(count: int, every: int) -> bool:
    return every > 0 and count % every == 0
