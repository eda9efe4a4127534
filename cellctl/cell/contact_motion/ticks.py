"""What is told of every tick of a streamed contact to whoever records or draws it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import StrEnum

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.force.contact.streamed.ticks import Pace
from cellctl.geometry.pose import Array


class MotionKind(StrEnum):
    """Which motion a tick belongs to, by its method in ``ContactMotions``."""

    HOLD = "hold"
    """The arm stands in its stream while something else is done."""
    MOVE_FREE = "move_free"
    TOUCH = "touch"
    PRESS = "press"
    SLIDE = "slide"
    TURN = "turn"
    COMPLY = "comply"
    FEED = "feed"
    BACK_OUT = "back_out"


@dataclass(frozen=True, slots=True, eq=False)
class ContactTick:
    """One tick of a streamed contact."""

    sample: ContactSample
    tip_command: Array
    """(6,): position (m) and rotation vector (rad) that were sent for it."""
    age_s: float
    """Time since the tick before."""
    force_age_s: float
    pace: Pace
    """How the next setpoint follows."""
    late: int
    """Setpoints that came too late since the stream began."""
    motion: int
    """Counts the motions of the stream from 1 on; the ticks of one motion have the same number."""
    kind: MotionKind
    at_bound: int = 0
    """Axes that had given way as far as they may."""
    speed_m_s: float = 0.0
    """Of the tip, as it was commanded: the way from the setpoint before in one period."""


class TickObserver(ABC):
    """Called in the loop, between two ticks: keep it short, and raise nothing."""

    @abstractmethod
    def take(self, tick: ContactTick) -> None:
        """A tick has passed."""


class Observers(TickObserver):
    """Tells several observers, in their order."""

    def __init__(self, *observers: TickObserver) -> None:
        self._observers = observers

    def take(self, tick: ContactTick) -> None:
        """See ``TickObserver``."""
        for observer in self._observers:
            observer.take(tick)


class NoObserver(TickObserver):
    """For a contact that nobody records or draws."""

    def take(self, tick: ContactTick) -> None:
        """Do nothing with it."""
