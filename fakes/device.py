"""What the fake cell knows of each of its devices."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Protocol

from fakes.faults import FaultBoard


class DeviceFaults(Protocol):
    """The faults of a device that keeps them itself."""

    def inject(self, name: str, *arguments: Any, **parameters: Any) -> None:
        """Switch a fault on; ``ValueError`` for a name that does not exist."""

    def clear(self) -> None:
        """Switch all faults off."""


@dataclass(frozen=True, slots=True)
class Device:
    """A server of the fake cell."""

    name: str
    port: int
    """Port on which it shall listen; 0 for any free port."""
    faults: FaultBoard | DeviceFaults
    start: Callable[[], Awaitable[int]]
    """Listens and returns the port, 0 for a device without one; ``OSError`` when it is taken."""
    stop: Callable[[], Awaitable[None]]
