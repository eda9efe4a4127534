"""The guard's own line to a robot: stop it, keep it alive, hear where its flange is.

Blocking by design, like ``FtSensor``: the guard is the only caller (docs/decisions/0003).
"""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import NamedTuple, Self


class FlangeState(NamedTuple):
    """What the controller reported on this channel."""

    time_s: float
    """Monotonic time of receipt."""
    position_m: tuple[float, float, float]
    """Origin of base_T_flange."""
    rotation: tuple[float, ...]
    """Rotation matrix of base_T_flange, nine numbers row by row; plain floats keep arrays out of
    the guard's loop."""
    moving: bool
    stop_latched: bool


class StopChannel(ABC):
    """Called by the guard process only.

    The controller stops by itself when heartbeats on this channel stay away (dead man), so the
    death of the guard stops the robot. Methods may raise ``ConnectTimeout``, ``LinkLost``,
    ``ProtocolViolation``.
    """

    @abstractmethod
    def open(self) -> None:
        """Establish the link."""

    @abstractmethod
    def close(self) -> None:
        """Drop the link. Idempotent."""

    @abstractmethod
    def fileno(self) -> int:
        """Descriptor that becomes readable when a report waits; -1 while closed."""

    @abstractmethod
    def request_stop(self) -> None:
        """Send the stop request now and return; does not wait for standstill. Repeatable."""

    @abstractmethod
    def heartbeat(self) -> None:
        """Tell the controller that the guard lives."""

    @abstractmethod
    def poll(self) -> FlangeState | None:
        """Read what has arrived without blocking; the newest report, or None."""

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
