"""The line PLC's connection: heartbeat out, cell heartbeat watched, one request at a time."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU

from fakes.wire.line.register_map import HEARTBEAT_ADDRESS, INPUT_COUNT, Report, read_report

HEARTBEAT_PERIOD_S = 0.25
"""Twice as often as the cell asks for at least (docs/plc-integration.md, Heartbeats)."""
POLL_PERIOD_S = 0.05
"""How often the input block is read, as by a PLC whose task runs every 50 ms."""
CELL_SILENT_S = 3.0
"""Time without another heartbeat of the cell after which this PLC gives it up."""


class CellLost(RuntimeError):
    """Connection or heartbeat of the cell is gone."""


@dataclass(slots=True)
class CellLink:
    """An open connection; ``run`` must be running while it is used."""

    client: AsyncModbusTcpClient
    on_report: Callable[[Report], None]
    report: Report | None = None
    _turn: asyncio.Lock = field(default_factory=asyncio.Lock)
    _news: asyncio.Event = field(default_factory=asyncio.Event)
    _ended: bool = False

    @classmethod
    async def open(
        cls, host: str, port: int, on_report: Callable[[Report], None], timeout_s: float
    ) -> "CellLink":
        """Connect, trying again until the time-out; raises ``CellLost``."""
        client = AsyncModbusTcpClient(
            host, port=port, timeout=2, retries=0, reconnect_delay=0, reconnect_delay_max=0
        )
        deadline = asyncio.get_running_loop().time() + timeout_s
        while not await client.connect():
            if asyncio.get_running_loop().time() > deadline:
                raise CellLost(f"no cell at {host}:{port}")
            await asyncio.sleep(0.2)
        return cls(client, on_report)

    async def run(self) -> None:
        """Beat and read until ``end``; raises ``CellLost`` or ``MapMismatch``."""
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._beat())
            tasks.create_task(self._poll())

    def end(self) -> None:
        """Beat and read no more.

        To be said beside a cancellation: where an answer comes in the very moment of it, the
        client's wait takes the answer and forgets the cancellation (Python before 3.12).
        """
        self._ended = True

    async def write(self, address: int, values: Sequence[int]) -> None:
        """FC16; raises ``CellLost`` when it is not confirmed."""
        async with self._turn:
            answer = await self._ask(self.client.write_registers(address, list(values)))
        if answer.isError():
            raise CellLost(f"write refused: {answer}")

    async def until(self, condition: Callable[[Report], bool], timeout_s: float) -> Report:
        """Wait for a report that fulfils the condition; raises ``TimeoutError``."""
        async with asyncio.timeout(timeout_s):
            while self.report is None or not condition(self.report):
                self._news.clear()
                await self._news.wait()
        return self.report

    async def _beat(self) -> None:
        count = await self._standing_beat()
        while not self._ended:
            count = count % 0xFFFF + 1
            await self.write(HEARTBEAT_ADDRESS, [count])
            await asyncio.sleep(HEARTBEAT_PERIOD_S)

    async def _standing_beat(self) -> int:
        """What an earlier life of this PLC left in the register: it counts on from there."""
        async with self._turn:
            answer = await self._ask(self.client.read_holding_registers(HEARTBEAT_ADDRESS))
        if answer.isError():
            raise CellLost(f"read refused: {answer}")
        return int(answer.registers[0])

    async def _poll(self) -> None:
        clock = asyncio.get_running_loop().time
        heartbeat, since = -1, clock()
        while not self._ended:
            async with self._turn:
                answer = await self._ask(self.client.read_input_registers(0, count=INPUT_COUNT))
            if answer.isError():
                raise CellLost(f"read refused: {answer}")
            self.report = read_report(answer.registers)
            if self.report.cell_heartbeat != heartbeat:
                heartbeat, since = self.report.cell_heartbeat, clock()
            elif clock() - since > CELL_SILENT_S:
                raise CellLost(f"cell heartbeat stands at {heartbeat}")
            self.on_report(self.report)
            self._news.set()
            await asyncio.sleep(POLL_PERIOD_S)

    async def _ask(self, request: Awaitable[ModbusPDU]) -> ModbusPDU:
        try:
            return await request
        except ModbusException as error:
            raise CellLost(str(error)) from error
