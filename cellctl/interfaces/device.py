"""What all devices share: a link that is established and dropped, also as a context."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Self

from cellctl.errors.base import CellError


class Device(ABC):
    """A device of the daemon's event loop."""

    name: str
    """The name in the cell file."""

    @abstractmethod
    async def connect(self) -> None:
        """Establish the link; ``ConnectTimeout``, ``VersionMismatch`` or ``PortInUse`` if not."""

    @abstractmethod
    async def disconnect(self) -> None:
        """Drop the link. Idempotent, in any state."""

    async def let_go(self) -> None:
        """Drop the link and write nothing: what the device drives stays as it was found.

        Called by `cellctl check --connect`, which has only asked. A driver whose ``disconnect``
        writes has one of its own. Idempotent, in any state.
        """
        await self.disconnect()

    def incidents(self) -> tuple[CellError, ...]:
        """What its driver has noticed beside its work since the last call, such as a stranger.

        Supervision asks a few times a second and makes alarms of them.
        """
        return ()

    async def __aenter__(self) -> Self:
        await self.connect()
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.disconnect()


class BlockingDevice(ABC):
    """A device of the guard process, which has no event loop (docs/decisions/0003)."""

    @abstractmethod
    def open(self) -> None:
        """Establish the link; ``ConnectTimeout`` or a fault of the protocol if not."""

    @abstractmethod
    def close(self) -> None:
        """Drop the link. Idempotent, in any state."""

    @abstractmethod
    def fileno(self) -> int:
        """Descriptor that becomes readable when something waits; -1 while closed."""

    def __enter__(self) -> Self:
        self.open()
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()
