"""TCP connections as the job language has them: client only, opened and closed by name."""

import asyncio
import re
import socket
from collections.abc import Callable
from contextlib import suppress

from fakes.faults import FaultBoard
from fakes.wire.sjl.sender import Sender

_CONNECT_S = 2.0
_WRONG_HELLOS = {
    "wrong_version": ("SJL,2", "SJL,9"),
    "wrong_euler": ("EUL=ZYX", "EUL=ZYZ"),
    "other_euler": ("EUL=ZYX", "EUL=XYZ"),
    "wrong_unit": ("UNIT=MMDEG", "UNIT=MRAD"),
    "wrong_name": (r"(CMD|STA|GRD),[^,]*", r"\1,NOBODY"),
}
_ACCEPTED = b"OKAY"
"""How the PC answers a hello that it accepts (docs/protocols/sjl-2.md)."""
_STOP, _STOP_BYTES = b"ABRT", 26
"""The word of a stop, and how long its record is (docs/protocols/sjl-2.md, section 3)."""


class JobSocket:
    """One connection. Opening it reports nothing, as the language has no result for it: that there
    is nobody shows only when something is received."""

    def __init__(self, faults: FaultBoard) -> None:
        self._faults = faults
        self._reader: asyncio.StreamReader | None = None
        self._writer: asyncio.StreamWriter | None = None
        self._sender: Sender | None = None
        self._sending: asyncio.Task[None] | None = None
        self.greeted = False
        """A PC has answered the hello of this connection."""

    async def create(self, host: str, port: int) -> None:
        """TCPCREATE."""
        await self.close()
        if self._faults.active("cut"):
            return
        with suppress(OSError, TimeoutError):
            async with asyncio.timeout(_CONNECT_S):
                self._reader, self._writer = await asyncio.open_connection(host, port)
            connection: socket.socket = self._writer.get_extra_info("socket")
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._sender = Sender(self._writer, self._faults)
            self._sending = asyncio.create_task(self._send_all(self._sender))

    def send(self, text: str) -> None:
        """TCPSEND."""
        if self._sender is not None and not self._overheard(text):
            self._sender.send(self._as_said(text).encode("ascii"))

    def _overheard(self, text: str) -> bool:
        """Whether a fault keeps an answer back, as a job that hangs does."""
        silent = {"ACK": "never_ack", "DONE": "never_done"}.get(text.partition(",")[0])
        return silent is not None and self._faults.use(silent) is not None

    def _as_said(self, text: str) -> str:
        """A hello as a job says it that was adapted wrongly on site."""
        if text.startswith("HELLO,"):
            for fault, (right, wrong) in _WRONG_HELLOS.items():
                if self._faults.active(fault):
                    text = re.sub(right, wrong, text)
        return text

    async def receive(self, most: int, timeout_ms: float) -> bytes | None:
        """TCPRECV: what is there, at most ``most`` bytes; nothing after the time-out, None when
        the connection is gone."""
        if self._reader is None:
            return None
        try:
            async with asyncio.timeout(timeout_ms / 1000):
                data = await self._reader.read(most)
        except TimeoutError:
            return b""
        except OSError:
            return None
        if self._faults.active("half_open"):
            return b""
        self.greeted = self.greeted or data.startswith(_ACCEPTED)
        return self._heard(data) if data else None

    def _heard(self, data: bytes) -> bytes:
        """What is left of stops that a fault lets the job overhear. A stop that comes in pieces is
        heard: the fault is a job that misses a word, not a line that loses bytes."""
        place = data.find(_STOP)
        if place < 0 or self._faults.use("ignore_stop") is None:
            return data
        return data[:place] + data[place + _STOP_BYTES :]

    async def close(self) -> None:
        """TCPCLOSE."""
        self.greeted = False
        writer, self._writer, self._reader, self._sender = self._writer, None, None, None
        if self._sending is not None:
            self._sending.cancel()
            await asyncio.gather(self._sending, return_exceptions=True)
            self._sending = None
        if writer is not None:
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    def cut(self) -> None:
        """The cable is pulled."""
        if self._writer is not None:
            self._writer.close()

    async def _send_all(self, sender: Sender) -> None:
        with suppress(OSError):
            await sender.run()


Sockets = dict[str, JobSocket]
Route = Callable[[str, int], tuple[str, int]]
"""The address in a job file to the one that is meant in this process."""
