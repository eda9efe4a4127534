"""The fake box on a python-can bus, and behind an slcan adapter on a pseudo terminal."""

import asyncio

import can

from fakes.wire.sri.can import CanFrame, CanSession
from fakes.wire.sri.core import SriCore
from fakes.wire.sri.links import Clock, Link, Pacer, cancel
from fakes.wire.sri.pty import PtyPort


class BusLink(Link):
    """A link on any bus of python-can, for instance ``can.Bus("name", interface="virtual")``."""

    def __init__(self, core: SriCore, clock: Clock, bus: can.BusABC) -> None:
        self._clock = clock
        self._bus = bus
        self._session = CanSession(core)
        self._pacer = Pacer(self._session, clock, self._write)
        self._session.connected(clock())
        self._sender = asyncio.create_task(self._pacer.run())
        loop = asyncio.get_running_loop()
        self._notifier = can.Notifier(bus, [self._receive], timeout=0.05, loop=loop)

    async def stop(self) -> None:
        """Leave the bus; closing it is left to who opened it."""
        await asyncio.to_thread(self._notifier.stop, 1.0)
        await cancel(self._sender)

    def _receive(self, message: can.Message) -> None:
        frame = CanFrame(message.arbitration_id, bytes(message.data))
        self._session.receive(frame, self._clock())
        self._pacer.wake()

    def _write(self, frame: CanFrame) -> bool:
        self._bus.send(can.Message(arbitration_id=frame.id, data=frame.data, is_extended_id=False))
        return True


class SlcanLink(Link):
    """A serial CAN adapter that speaks slcan, with the box alone on its bus."""

    def __init__(self, core: SriCore, clock: Clock) -> None:
        self._clock = clock
        self._session = CanSession(core)
        self._port = PtyPort(self._receive)
        self._pacer = Pacer(self._session, clock, self._write)
        self._line = bytearray()
        self._open = False
        self._session.connected(clock())
        self._sender = asyncio.create_task(self._pacer.run())

    @property
    def path(self) -> str:
        """Device file for the client."""
        return self._port.path

    async def stop(self) -> None:
        """Pull the adapter."""
        await cancel(self._sender)
        self._port.close()

    def _receive(self, data: bytes) -> None:
        self._line += data
        while (end := self._line.find(b"\r")) >= 0:
            line = self._line[:end].decode("ascii", "replace")
            del self._line[: end + 1]
            self._port.write(self._execute(line))
        self._pacer.wake()

    def _execute(self, line: str) -> bytes:
        """One adapter command; BEL is its error answer."""
        if line in ("O", "L"):
            self._open = True
        elif line == "C":
            self._open = False
        elif line == "V":
            return b"V1013\r"
        elif line == "N":
            return b"NFAKE\r"
        elif line.startswith("t"):
            return self._transmit(line)
        elif line and line[0] not in "Ss":
            return b"\a"
        return b"\r"

    def _transmit(self, line: str) -> bytes:
        """``tiiil<data>``: a message from the client onto the bus."""
        try:
            frame = CanFrame(int(line[1:4], 16), bytes.fromhex(line[5:]))
            valid = self._open and int(line[4], 16) == len(frame.data)
        except (ValueError, IndexError):
            return b"\a"
        if not valid:
            return b"\a"
        self._session.receive(frame, self._clock())
        return b"z\r"

    def _write(self, frame: CanFrame) -> bool:
        if not self._open:
            return False
        text = f"t{frame.id:03X}{len(frame.data)}{frame.data.hex().upper()}\r"
        return self._port.write(text.encode("ascii"))
