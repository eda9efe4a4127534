"""A large-field head that measures 3-D targets in its own frame."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class Target:
    """One measured target."""

    name: str
    position_m: Array
    """Shape (3,), in the frame of the head."""
    sigma_m: float
    """Standard deviation of each coordinate as the head states it."""


class TargetTracker(ABC):
    """Called by calibration procedures while everything stands still.

    Methods may raise ``ConnectTimeout``, ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation``.
    """

    name: str

    @abstractmethod
    async def connect(self) -> None:
        """Establish the link. Idempotent."""

    @abstractmethod
    async def disconnect(self) -> None:
        """Drop the link. Idempotent, in any state."""

    @abstractmethod
    async def serial_number(self) -> str:
        """Serial number of the head."""

    @abstractmethod
    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        """Measure all visible targets now, averaged over ``frames`` exposures."""

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
