"""A stereo head: two cameras that expose together."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class StereoPair:
    """Two images of one exposure."""

    left: Image
    """Shape (height, width), 8 bit grey, pixel centres at integers."""
    right: Image
    time_s: float
    """Monotonic time of receipt of the request's exposure."""
    frame_id: int
    """Counts up by one a pair; a repeated number is a repeated image."""


class StereoCamera(ABC):
    """Called by steps and calibration procedures while the head stands still.

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
        """Serial number of the head, for the record and the calibration gate."""

    @abstractmethod
    async def grab(self) -> StereoPair:
        """Expose now and return a pair that was exposed after this call."""

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
