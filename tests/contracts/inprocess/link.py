"""The link of a device in memory: what all that can be connected share."""

from cellctl.errors.link import LinkLost


class InProcessLink:
    """Connected or not; ``_check`` raises as a driver without a link does."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._connected = False

    async def connect(self) -> None:
        self._connected = True

    async def disconnect(self) -> None:
        self._connected = False

    async def serial_number(self) -> str:
        self._check()
        return "MEMORY-1"

    def _check(self) -> None:
        if not self._connected:
            raise LinkLost(self.name)
