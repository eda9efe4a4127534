"""The guard's own line to a robot: stop it, keep it alive, hear where its flange is.

Blocking by design, like ``FtSensor``: the guard is the only caller (docs/decisions/0003).
"""

from abc import abstractmethod
from typing import NamedTuple

from cellctl.interfaces.device import BlockingDevice


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


class StopChannel(BlockingDevice):
    """Called by the guard process only.

    The controller stops by itself when heartbeats on this channel stay away (dead man), so the
    death of the guard stops the robot. Methods may raise ``ConnectTimeout``, ``LinkLost``,
    ``ProtocolViolation``.
    """

    @abstractmethod
    def request_stop(self) -> None:
        """Send the stop request now and return; does not wait for standstill. Repeatable."""

    def repeat_stop(self) -> None:
        """Ask again for a stop that was requested and is not reported as latched yet.

        Called at every beat until it is. A channel whose far end reads slowly may leave some out:
        requests that queue up there would be obeyed after the release of the latch.
        """
        self.request_stop()

    @abstractmethod
    def heartbeat(self) -> None:
        """Tell the controller that the guard lives."""

    @abstractmethod
    def poll(self) -> FlangeState | None:
        """Read what has arrived without blocking; the newest report, or None.

        The guard calls it in the loop that judges every sample, which must never wait for a robot.
        """
