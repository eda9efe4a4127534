"""A robot that follows small pose corrections at its controller's own rate."""

from abc import ABC, abstractmethod
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.interfaces.robot import Robot


@dataclass(frozen=True, slots=True)
class StreamLimits:
    """What a stream may at most do. The PC checks it before sending and the controller again."""

    step_m: float
    """Way of the setpoint from one tick of the controller to the next."""
    step_rad: float
    travel_m: float
    """Distance of the setpoint from the flange's pose at the beginning of the stream."""
    travel_rad: float
    loss_s: float
    """Time without a new setpoint after which the controller ends the stream at standstill, and
    without a tick after which the PC does."""


@dataclass(frozen=True, slots=True)
class StreamOffer:
    """What the controller can do."""

    period_s: float
    """Time from one tick to the next."""
    limits: StreamLimits
    """The greatest that it accepts, and that the configuration of this cell allows."""


@dataclass(frozen=True, slots=True)
class StreamReport:
    """What the controller said at one of its ticks."""

    time_s: float
    """Monotonic time of receipt."""
    tick: int
    """Counts up by one with each period; the first tick of a stream is 1. A number that is skipped
    is a report that this PC was too late to look at."""
    base_T_flange: RigidTransform
    """Where the flange really is, by the encoders."""
    late: int
    """Setpoints since the beginning that came after the tick for which they were meant, or twice.
    """
    lost: int
    """Ticks since the beginning that found no new setpoint. The robot stood still or finished its
    last step then; what was lost is not made up for."""
    sent_s: float
    """Monotonic time at which this PC sent its newest setpoint; before the first, ``time_s``."""


class PoseStream(ABC):
    """A stream that is running. Used by one task at a time."""

    period_s: float
    limits: StreamLimits

    @property
    @abstractmethod
    def report(self) -> StreamReport:
        """The newest report."""

    @abstractmethod
    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        """Send the setpoint of the next tick and return the report of that tick.

        Returns the newest report when more than one tick has passed. To stand still, send the last
        setpoint again: a stream without setpoints is a fault, not a pause.

        Raises ``TargetOutOfBounds`` when the setpoint exceeds the limits of the stream or the
        bounds of the site; it was not sent then, and the next one counts from the last that was.
        Every other fault means that the stream has ended: ``StreamStale``, ``SetpointRefused``,
        ``MotionAborted`` (a stop by guard, operator or controller), ``ControllerFault``,
        ``StreamSilent``, or a fault of the link.
        """


class StreamingRobot(Robot):
    """A robot whose controller accepts a stream of setpoints.

    The force guard stays armed over its own channel, and its stop ends a stream like any motion.
    """

    @abstractmethod
    def stream_offer(self) -> StreamOffer:
        """What the connected controller offers; raises ``StreamNotOffered`` or ``LinkLost``."""

    @abstractmethod
    def stream(self, limits: StreamLimits) -> AbstractAsyncContextManager[PoseStream]:
        """Follow setpoints from the present pose on, as long as the context lasts.

        Entering returns with the first report and moves nothing. Leaving the context normally ends
        the stream at standstill, without a latch. Leaving it by an exception or by cancellation
        stops the robot and latches, as with every motion that is given up; so does any end that the
        controller brings about. Nothing resumes by itself.

        Entering raises what a motion raises, ``StreamNotOffered``, or ``TargetOutOfBounds`` when
        the limits exceed what is offered. A stream that the controller has ended raises its fault
        at the latest when the context is left.
        """
