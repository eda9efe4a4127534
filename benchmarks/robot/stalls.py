"""How long a process of a benchmark got no turn, which no driver or controller can make up for."""

import asyncio
import time

_LOOK_S = 0.002


class StallWatch:
    """Looks at the clock in its event loop, as long as the context lasts."""

    def __init__(self) -> None:
        self.longest_s = 0.0
        """Longest time by which a look came late: the loop was busy, or its process had no
        processor."""

    async def __aenter__(self) -> "StallWatch":
        self._looking = asyncio.create_task(self._look())
        return self

    async def __aexit__(self, *_: object) -> None:
        self._looking.cancel()
        await asyncio.gather(self._looking, return_exceptions=True)

    async def _look(self) -> None:
        while True:
            due_s = time.monotonic() + _LOOK_S
            await asyncio.sleep(_LOOK_S)
            self.longest_s = max(self.longest_s, time.monotonic() - due_s)
