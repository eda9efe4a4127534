"""Named signals behind a coupler: fresh values, checked outputs, and its watchdog kept served."""

import asyncio
import contextlib
import logging
from collections.abc import Coroutine, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.digital_io import OutputsDropped, WatchdogUnsuitable
from cellctl.errors.link import LinkError, LinkLost
from drivers.modbus.client import ModbusClient
from drivers.modbus.settings import CouplerSettings
from drivers.modbus.signals import SignalMap

_log = logging.getLogger(__name__)
Value = TypeVar("Value")
POLLS_PER_WATCHDOG = 4
"""Looks at the signals within the time of the coupler's watchdog: two in a row may be late."""


@dataclass(frozen=True, slots=True)
class SignalReading:
    """All signals of a coupler at one time."""

    time_s: float
    inputs: dict[str, bool]
    outputs: dict[str, bool]


class Coupler:
    """Between ``connect`` and ``disconnect`` the signals are read often enough for the coupler's
    watchdog. The poll never writes: an output that the watchdog has switched off must stay off.

    Every fault ends the link, because it leaves open what the outputs do. It is raised by every
    call until ``connect`` is called again.
    """

    def __init__(
        self,
        name: str,
        settings: CouplerSettings,
        inputs: Mapping[str, int],
        outputs: Mapping[str, int],
    ) -> None:
        self._name = name
        self._settings = settings
        self._client = ModbusClient(name, settings)
        self._inputs, self._outputs = SignalMap(inputs), SignalMap(outputs)
        self._turn = asyncio.Lock()
        self._expected: dict[str, bool] = {}
        """Outputs as this PC has set them or found them."""
        self._fault: CellError | None = LinkLost(f"{name} is not connected")
        """Why nothing can be asked; None while the link is sound."""
        self._polling: asyncio.Task[None] | None = None

    async def connect(self) -> None:
        """Connect, check the watchdog, and take over the outputs as they are. Idempotent."""
        async with self._turn:
            if self._fault is None:
                return
            await self._stop_polling()
            try:
                await self._client.open()
                # Checked before anything is switched: without a watchdog, outputs would stay on
                # when this PC dies.
                watchdog_s = await self._watchdog_s()
                self._expected = self._outputs.values(await self._read_outputs())
            except BaseException:
                self._client.close()
                raise
            self._fault = None
            # Four times a period: one lost or late poll must not drop the outputs.
            self._polling = asyncio.create_task(self._poll(watchdog_s / POLLS_PER_WATCHDOG))

    async def disconnect(self) -> None:
        """Switch every output off and drop the link. Idempotent."""
        async with self._turn:
            await self._stop_polling()
            if self._fault is None:
                self._fault = LinkLost(f"{self._name} is not connected")
                try:
                    # Asked for, although the watchdog would do the same: it takes up to a second.
                    for address in self._outputs.addresses.values():
                        await self._client.write_output(address, value=False)
                except LinkError as error:
                    # Nobody is left to tell; the coupler's watchdog does what could not be asked.
                    _log.warning(
                        "%s: outputs left to the coupler's watchdog: %s", self._name, error
                    )
            self._client.close()

    async def let_go(self) -> None:
        """Drop the link and leave the outputs as they are, or as the watchdog puts them."""
        async with self._turn:
            await self._stop_polling()
            self._fault = LinkLost(f"{self._name} is not connected")
            self._client.close()

    async def read(self) -> SignalReading:
        """Ask for all signals now; ``OutputsDropped`` when outputs are not as they were set."""
        async with self._turn:
            return await _to_its_end(self._guarded_read())

    async def write(self, outputs: Mapping[str, bool]) -> None:
        """Set outputs in the order given."""
        async with self._turn:
            await _to_its_end(self._guarded_write(outputs))

    async def _guarded_write(self, outputs: Mapping[str, bool]) -> None:
        # Before switching anything, see that nothing was switched behind our back: an order that
        # rests on outputs which the watchdog has dropped must not be carried out.
        await self._guarded_read()
        try:
            for name, value in outputs.items():
                await self._client.write_output(self._outputs.addresses[name], value=value)
                self._expected[name] = value
        except CellError as fault:
            self._end(fault)
            raise

    async def _guarded_read(self) -> SignalReading:
        self._check()
        try:
            reading = await self._read()
        except CellError as fault:
            self._end(fault)
            raise
        if reading.outputs != self._expected:
            changed = [n for n, value in reading.outputs.items() if value != self._expected[n]]
            dropped = OutputsDropped(f"{self._name}: {', '.join(changed)}")
            self._end(dropped)
            raise dropped
        return reading

    async def _read(self) -> SignalReading:
        bits: list[bool] = []
        if self._inputs.count:
            bits = await self._client.read_inputs(self._inputs.start, self._inputs.count)
        outputs = self._outputs.values(await self._read_outputs())
        return SignalReading(now_s(), self._inputs.values(bits), outputs)

    async def _read_outputs(self) -> list[bool]:
        if not self._outputs.count:
            return []
        return await self._client.read_outputs(self._outputs.start, self._outputs.count)

    async def _watchdog_s(self) -> float:
        """The coupler's watchdog time; ``WatchdogUnsuitable`` when it is off or too long."""
        settings = self._settings
        counts = await self._client.read_register(settings.watchdog_register)
        watchdog_s = counts * settings.watchdog_unit_ms / 1000.0
        if not 0.0 < watchdog_s <= settings.max_watchdog_s:
            state = f"{watchdog_s:g} s" if counts else "off"
            raise WatchdogUnsuitable(
                f"{self._name}: watchdog {state}, allowed up to {settings.max_watchdog_s:g} s"
            )
        return watchdog_s

    async def _poll(self, period_s: float) -> None:
        """Read for ever; the first fault ends the link and stays for the next caller."""
        with contextlib.suppress(CellError):  # kept by ``_end``
            while True:
                await asyncio.sleep(period_s)
                await self.read()

    async def _stop_polling(self) -> None:
        task, self._polling = self._polling, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    def _check(self) -> None:
        if self._fault is not None:
            # A new exception each time: raised again, one object would collect the tracebacks of
            # all its callers.
            raise type(self._fault)(self._fault.detail)

    def _end(self, fault: CellError) -> None:
        self._fault = fault
        _log.warning("%s: %s", self._name, fault)
        self._client.close()


async def _to_its_end(exchange: Coroutine[Any, Any, Value]) -> Value:
    """Finish an exchange even when its caller is cancelled meanwhile, and only then let the caller
    go. Given up halfway it would leave it open what the coupler has done; it takes no longer than
    the reply time-out of its requests."""
    task = asyncio.ensure_future(exchange)
    cancelled = False
    while not task.done():
        try:
            await asyncio.wait({task})
        except asyncio.CancelledError:
            cancelled = True
    if cancelled:
        task.exception()  # seen, and kept by ``_end`` for the next caller
        raise asyncio.CancelledError
    return task.result()
