"""A gripper with two jaws that tells whether it holds a part."""

from abc import abstractmethod
from dataclasses import dataclass

from cellctl.interfaces.device import Device


@dataclass(frozen=True, slots=True)
class GripperState:
    """What the gripper's sensors say. Between the end positions ``opened`` and ``closed`` are both
    false."""

    time_s: float
    """Monotonic time at which the sensors' values were complete on this PC."""
    opened: bool
    """The jaws stand at their open end position."""
    closed: bool
    """The jaws have closed, on a part or without one."""
    part_present: bool
    """There is a part between the jaws, gripped or not."""


class Gripper(Device):
    """Called by steps, from the daemon's event loop only, while the robot stands still.

    Methods state goals: one that is already reached is confirmed and nothing moves. Cancelling a
    call does not stop the jaws; they go on to their end position, and the next call says where
    they are.

    Neither connecting nor disconnecting nor losing the link moves the jaws. A gripper that holds
    a part keeps it.

    Every method may raise ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation``, ``DeviceFault``,
    ``OutputsDropped`` or ``GripperSensorsDisagree``; ``connect`` also ``WatchdogUnsuitable``.
    ``connect`` does nothing while the link stands; Clear calls it.
    """

    @abstractmethod
    async def state(self) -> GripperState:
        """Ask the sensors now."""

    @abstractmethod
    async def open(self) -> GripperState:
        """Open fully; raises ``GripperNotOpened`` when the open end position is not reached."""

    @abstractmethod
    async def close(self) -> GripperState:
        """Close on a part.

        Raises ``GripperNotClosed`` when the jaws do not close in time, ``NoPartGripped`` when they
        have closed and there is no part between them.
        """

    @abstractmethod
    async def confirm_part(self) -> GripperState:
        """See that the jaws still hold the part; raises ``PartLost``. Moves nothing."""
