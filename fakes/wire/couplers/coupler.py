"""A fake Modbus TCP coupler with digital inputs, digital outputs and a watchdog.

Written from docs/protocols/modbus-coupler.md and the Modbus specifications. What is wired to it is
given by two functions, so the same coupler carries a gripper, lamps, or nothing but its inputs.
"""

import asyncio
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Final

from fakes.wire.couplers import modbus_pdu
from fakes.wire.couplers.modbus_pdu import ExceptionCode, Request
from fakes.wire.named_faults import NamedFaults

WATCHDOG_REGISTER: Final = 0x1120
"""That of Beckhoff's couplers (docs/protocols/modbus-coupler.md, Watchdog)."""
COUPLER_FAULTS: Final[dict[str, str]] = {
    "silent": "the request is carried out and never answered",
    "half_open": "the connection stands, but nothing more is read or written on it",
    "hang_up": "the connection is closed in place of an answer",
    "late": "the answer comes so many seconds late (value)",
    "split": "the answer leaves byte by byte",
    "exception": "the answer is the exception with this code (value)",
    "wrong_transaction": "the answer carries the number of another request",
    "wrong_function": "the answer is that of another function",
    "short": "the answer is cut off, with a length that says so",
    "deaf_outputs": "outputs are confirmed and not switched",
}
Inputs = Callable[[float], Mapping[int, bool]]
"""The inputs at a time, by address."""
Outputs = Callable[[float, Mapping[int, bool]], None]
"""Told of the outputs at a time, by address, whenever they may have changed."""


class CouplerServer:
    """Serves any number of clients. Each request of any of them restarts the watchdog."""

    def __init__(
        self,
        clock: Callable[[], float],
        *,
        inputs: Inputs,
        output_addresses: Iterable[int],
        on_outputs: Outputs | None = None,
        watchdog_ms: int = 500,
    ) -> None:
        self.faults = NamedFaults(COUPLER_FAULTS)
        self.writes = 0
        """Outputs that were told to switch or stay."""
        self.watchdog_ms = watchdog_ms
        self._clock = clock
        self._inputs = inputs
        self._outputs = dict.fromkeys(output_addresses, False)
        self._on_outputs = on_outputs
        self._heard_s: float | None = None
        self._server: asyncio.Server | None = None
        self._clients: set[asyncio.Task[None]] = set()

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen; returns the port."""
        self._server = await asyncio.start_server(self._serve, host, port)
        return int(self._server.sockets[0].getsockname()[1])

    async def stop(self) -> None:
        """Hang up and stop listening. Idempotent."""
        server, self._server = self._server, None
        if server is None:
            return
        server.close()
        for task in self._clients:
            task.cancel()
        await asyncio.gather(*self._clients, return_exceptions=True)
        await server.wait_closed()

    @property
    def outputs(self) -> dict[int, bool]:
        """Outputs as they are driven now."""
        self._watch()
        return dict(self._outputs)

    def drop_outputs(self) -> None:
        """Switch every output off, as when the watchdog runs down or the supply fails."""
        self._outputs = dict.fromkeys(self._outputs, False)
        self._tell()

    # -- image of the process, as requests see it ----------------------------------------------
    def coils(self, start: int, count: int) -> Sequence[bool]:
        """Outputs; an address without an output in the middle of others reads as off."""
        return self._slice(self._outputs, start, count)

    def inputs(self, start: int, count: int) -> Sequence[bool]:
        """Inputs; an address without an input in the middle of others reads as off."""
        return self._slice(self._inputs(self._clock()), start, count)

    def registers(self, start: int, count: int) -> Sequence[int]:
        """The watchdog time is the only register."""
        if (start, count) != (WATCHDOG_REGISTER, 1):
            raise ExceptionCode(ExceptionCode.ILLEGAL_ADDRESS)
        return [self.watchdog_ms]

    def write_coils(self, start: int, values: Sequence[bool]) -> None:
        """Switch outputs."""
        addresses = range(start, start + len(values))
        if not self._outputs.keys() >= set(addresses):
            raise ExceptionCode(ExceptionCode.ILLEGAL_ADDRESS)
        self.writes += len(values)
        self._outputs.update(zip(addresses, values, strict=True))
        self._tell()

    @staticmethod
    def _slice(values: Mapping[int, bool], start: int, count: int) -> Sequence[bool]:
        if not {start, start + count - 1} <= values.keys():
            raise ExceptionCode(ExceptionCode.ILLEGAL_ADDRESS)
        return [values.get(address, False) for address in range(start, start + count)]

    def _watch(self) -> None:
        """Drop the outputs when no request has come for the watchdog's time. It is enough to look
        whenever somebody asks: nobody sees the outputs in between."""
        ended = self._heard_s is not None and self.watchdog_ms > 0
        if ended and self._clock() - (self._heard_s or 0.0) > self.watchdog_ms / 1000:
            self._heard_s = None
            self.drop_outputs()

    def _tell(self) -> None:
        if self._on_outputs is not None:
            self._on_outputs(self._clock(), self._outputs)

    # -- connections ---------------------------------------------------------------------------
    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None  # a coroutine always runs in one
        self._clients.add(task)
        try:
            # A client that goes, in whatever way, ends its connection and nothing else.
            with suppress(ConnectionError, asyncio.IncompleteReadError, asyncio.CancelledError):
                while await self._exchange(reader, writer):
                    pass
        finally:
            self._clients.discard(task)
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def _exchange(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bool:
        """One request and its answer; False when the connection is to end."""
        header = await reader.readexactly(modbus_pdu.HEADER.size)
        transaction, protocol, length, unit = modbus_pdu.HEADER.unpack(header)
        if protocol != 0 or not 2 <= length <= modbus_pdu.MAX_LENGTH:
            return False
        request = Request(transaction, unit, await reader.readexactly(length - 1))
        faults = self.faults.take()
        if "half_open" in faults:
            await asyncio.Event().wait()  # ended by the server's stop
        self._watch()
        self._heard_s = self._clock()
        data = self._answer(request, faults)
        await asyncio.sleep(faults.get("late", 0.0))
        if "hang_up" in faults:
            return False
        if "silent" not in faults:
            for piece in _pieces(data, faults):
                writer.write(piece)
                await writer.drain()
        return True

    def _answer(self, request: Request, faults: Mapping[str, float]) -> bytes:
        if "exception" in faults:
            function = request.pdu[0] | 0x80
            return modbus_pdu.framed(request, bytes([function, int(faults["exception"])]))
        if "deaf_outputs" in faults and request.pdu[0] == modbus_pdu.WRITE_COIL:
            return modbus_pdu.framed(request, request.pdu)
        pdu = modbus_pdu.answer(request, self)
        if "wrong_function" in faults:
            other = modbus_pdu.READ_COILS + (pdu[0] == modbus_pdu.READ_COILS)
            pdu = bytes([other, 1, 0])
        if "short" in faults:
            pdu = pdu[:-1]
        if "wrong_transaction" in faults:
            request = Request((request.transaction + 7) % 65536, request.unit, request.pdu)
        return modbus_pdu.framed(request, pdu)


def _pieces(data: bytes, faults: Mapping[str, float]) -> list[bytes]:
    if "split" in faults:
        return [data[index : index + 1] for index in range(len(data))]
    return [data]
