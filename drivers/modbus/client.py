"""One TCP connection to a Modbus coupler: requests, checked answers, numbered faults."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import NoReturn

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ExceptionResponse, ModbusPDU

from cellctl.errors.link import ConnectTimeout, LinkLost, ProtocolViolation
from drivers.modbus import faults
from drivers.modbus.settings import CouplerSettings

_log = logging.getLogger(__name__)
Request = Callable[[AsyncModbusTcpClient], Awaitable[ModbusPDU]]


class ModbusClient:
    """Requests that do not end as they should close the connection, because a late answer would
    otherwise be taken for that of the next request. An exception response does not: it is a whole
    and proper answer.
    """

    def __init__(self, name: str, settings: CouplerSettings) -> None:
        self.peer = f"{name}, coupler {settings.host}:{settings.port}"
        self._settings = settings
        self._client: AsyncModbusTcpClient | None = None
        self._lost = asyncio.Event()
        self._transaction = 0

    @property
    def connected(self) -> bool:
        """A connection stands."""
        return self._client is not None and self._client.connected and not self._lost.is_set()

    async def open(self) -> None:
        """Connect; ``ConnectTimeout`` when nobody answers."""
        self.close()
        settings, lost = self._settings, asyncio.Event()

        def changed(connected: bool) -> None:  # noqa: FBT001  signature given by pymodbus
            if not connected:
                lost.set()

        def traced(sending: bool, pdu: ModbusPDU) -> ModbusPDU:  # noqa: FBT001  likewise
            if sending:
                self._transaction = pdu.transaction_id
            return pdu

        # Neither retries nor reconnection by the library: a request that was repeated, or sent on
        # a new connection, could switch an output on that the coupler has switched off meanwhile.
        client = AsyncModbusTcpClient(
            settings.host,
            port=settings.port,
            # One limit of the library serves connecting and answers; both are watched here instead.
            timeout=settings.connect_timeout_s + settings.reply_timeout_s,
            retries=0,
            reconnect_delay=0,
            reconnect_delay_max=0,
            trace_connect=changed,
            trace_pdu=traced,
        )
        try:
            async with asyncio.timeout(settings.connect_timeout_s):
                connected = await client.connect()
        except TimeoutError:
            connected = False
        if not connected:
            client.close()
            raise ConnectTimeout(f"{self.peer}: no answer")
        self._client, self._lost = client, lost
        _log.info("%s: connected", self.peer)

    def close(self) -> None:
        """Drop the connection. Idempotent."""
        client, self._client = self._client, None
        self._lost.set()
        if client is not None:
            client.close()

    async def read_inputs(self, start: int, count: int) -> list[bool]:
        """Discrete inputs (function 2)."""
        return await self._bits(
            2, count, lambda c: c.read_discrete_inputs(start, count=count, device_id=self._unit)
        )

    async def read_outputs(self, start: int, count: int) -> list[bool]:
        """Coils (function 1), as the coupler drives them."""
        return await self._bits(
            1, count, lambda c: c.read_coils(start, count=count, device_id=self._unit)
        )

    async def write_output(self, address: int, *, value: bool) -> None:
        """One coil (function 5); the coupler must echo address and value."""
        answer = await self._ask(5, lambda c: c.write_coil(address, value, device_id=self._unit))
        # The echo is the only confirmation that the right output was switched.
        if answer.address != address or answer.bits[:1] != [value]:
            self._violation(f"echo of output {answer.address} instead of {address}")

    async def read_register(self, address: int) -> int:
        """One holding register (function 3)."""
        answer = await self._ask(
            3, lambda c: c.read_holding_registers(address, count=1, device_id=self._unit)
        )
        if len(answer.registers) != 1:
            self._violation(f"{len(answer.registers)} registers instead of 1")
        return int(answer.registers[0])

    @property
    def _unit(self) -> int:
        return self._settings.unit

    async def _bits(self, function: int, count: int, request: Request) -> list[bool]:
        answer = await self._ask(function, request)
        # Answers carry whole bytes; the bits behind the last one that was asked for are padding.
        if len(answer.bits) != 8 * ((count + 7) // 8):
            self._violation(f"{len(answer.bits)} bits instead of {count}")
        return [bool(bit) for bit in answer.bits[:count]]

    async def _ask(self, function: int, request: Request) -> ModbusPDU:
        """The answer to a request; it has the request's function code."""
        client, lost = self._client, self._lost
        if client is None or not self.connected:
            raise LinkLost(f"{self.peer} is not connected")
        try:
            answer = await self._answer(client, lost, request)
        except BaseException:
            self.close()
            raise
        # pymodbus lets answers pass whose transaction number is 0.
        if answer.transaction_id != self._transaction:
            self._violation(f"answer {answer.transaction_id} instead of {self._transaction}")
        if isinstance(answer, ExceptionResponse):
            raise faults.refused(self.peer, answer)
        if answer.function_code != function:
            self._violation(f"answer of function {answer.function_code} instead of {function}")
        return answer

    async def _answer(
        self, client: AsyncModbusTcpClient, lost: asyncio.Event, request: Request
    ) -> ModbusPDU:
        """Wait for the answer, its time limit, or the end of the connection, of which pymodbus
        itself does not tell the one who waits."""
        # Two tasks side by side, because the library lets the request wait for its time-out when
        # the connection ends meanwhile.
        asking = asyncio.ensure_future(request(client))
        losing = asyncio.ensure_future(lost.wait())
        timeout_s = self._settings.reply_timeout_s
        try:
            await asyncio.wait(
                {asking, losing}, timeout=timeout_s, return_when=asyncio.FIRST_COMPLETED
            )
            if asking.done():
                return asking.result()
            raise faults.closed(self.peer) if losing.done() else faults.silent(self.peer, timeout_s)
        except ModbusException as error:
            raise ProtocolViolation(f"{self.peer}: {error}") from error
        finally:
            for task in (asking, losing):
                task.cancel()
            await asyncio.gather(asking, losing, return_exceptions=True)

    def _violation(self, facts: str) -> NoReturn:
        self.close()
        raise ProtocolViolation(f"{self.peer}: {facts}")
