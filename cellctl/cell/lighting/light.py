"""A lamp at a digital output: on while an image is exposed, off otherwise."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from cellctl import log
from cellctl.errors import CellError
from cellctl.interfaces import DigitalIo

_log = log.get(__name__)


class Light:
    """One output, for any number of cameras: on as long as one of them exposes."""

    def __init__(self, io: DigitalIo, output: str) -> None:
        self._io, self._output = io, output
        self._users = 0
        self._turn = asyncio.Lock()
        self._switching: set[asyncio.Task[CellError | None]] = set()

    @asynccontextmanager
    async def on(self, settle_s: float) -> AsyncIterator[None]:
        """Inside, the lamp has been on for ``settle_s``; raises the fault of its output.

        It is switched off however the exposure ends. Where both fail, the fault of the exposure is
        raised and that of the output logged.
        """
        # Before anything is awaited: a camera that ends now must leave the lamp on.
        self._users += 1
        try:
            await self._switched()
            await asyncio.sleep(settle_s)
            yield
        except BaseException:
            self._users -= 1
            await self._logged_switch()
            raise
        self._users -= 1
        await self._switched()

    async def _switched(self) -> None:
        fault = await self._to_the_end()
        if fault is not None:
            raise fault

    async def _logged_switch(self) -> None:
        fault = await self._to_the_end()
        if fault is not None:
            _log.warning("light not switched off", output=self._output, fault=str(fault))

    async def _to_the_end(self) -> CellError | None:
        """The fault of the output, if any; the write ends also when the caller is cancelled.

        A driver may drop its link over a write that is cancelled, and with it every output of the
        device: an arm may be permitted by one of them.
        """
        switching = asyncio.create_task(self._write())
        self._switching.add(switching)
        switching.add_done_callback(self._switching.discard)
        return await asyncio.shield(switching)

    async def _write(self) -> CellError | None:
        async with self._turn:
            try:
                await self._io.write({self._output: self._users > 0})
            except CellError as fault:
                return fault
            return None
