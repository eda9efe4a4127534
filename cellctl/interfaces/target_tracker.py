"""A large-field head that measures 3-D targets in its own frame."""

from abc import abstractmethod
from dataclasses import dataclass

from cellctl.geometry.pose import Array
from cellctl.interfaces.device import Device


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """One measured target."""

    name: str
    position_m: Array
    """Shape (3,), in the frame of the head."""
    sigma_m: float
    """Standard deviation of each coordinate as the head states it."""


class TargetTracker(Device):
    """Called by calibration procedures while everything stands still.

    Methods may raise ``ConnectTimeout``, ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation``.
    """

    @abstractmethod
    async def serial_number(self) -> str:
        """Serial number of the head."""

    @abstractmethod
    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        """Measure all visible targets now, averaged over ``frames`` exposures."""
