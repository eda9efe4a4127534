"""A pneumatic gripper with a double solenoid valve: where its jaws are and what its sensors see."""

from dataclasses import dataclass, field

OPEN_END, ON_PART, CLOSED_END = 0.0, 0.8, 1.0
"""Position of the jaws as a ratio of their travel; a part stops them on their way to closed."""
_SWITCH_RATIO = 0.02
"""The end position sensors switch this far before their end."""


@dataclass(slots=True)
class PneumaticJaws:
    """Jaws that travel at constant speed to where the valve last sent them.

    Every method takes the time, which never runs backwards.
    """

    travel_s: float = 0.15
    """Time from one end position to the other."""
    part_present: bool = True
    stuck: bool = False
    """The jaws do not move any more, whatever the valve does."""
    broken: dict[str, bool] = field(default_factory=dict)
    """Sensors by name (``opened``, ``closed``, ``part``) that show this value for ever."""
    travels: int = 0
    """How often the jaws have begun to move."""
    _position: float = OPEN_END
    _closing: bool = False
    _time_s: float = 0.0

    def drive(self, time_s: float, *, open_coil: bool, close_coil: bool) -> None:
        """Switch the coils. The valve changes only for a coil that is alone, and stays where it is
        without any."""
        self.position(time_s)
        if close_coil not in {open_coil, self._closing}:
            self._closing = close_coil
            self.travels += self._target != self._position

    def position(self, time_s: float) -> float:
        """Ratio of the travel, 0 open to 1 closed."""
        way = (time_s - self._time_s) / self.travel_s
        self._time_s = time_s
        if not self.stuck:
            left = self._target - self._position
            self._position += max(-way, min(way, left))
        return self._position

    @property
    def last_position(self) -> float:
        """Where they were when the coupler last looked, as a ratio of the travel."""
        return self._position

    def sensors(self, time_s: float) -> dict[str, bool]:
        """What the three sensors show."""
        position = self.position(time_s)
        shown = {
            "opened": position <= OPEN_END + _SWITCH_RATIO,
            "closed": position >= ON_PART - _SWITCH_RATIO,
            "part": self.part_present,
        }
        return shown | self.broken

    @property
    def _target(self) -> float:
        if not self._closing:
            return OPEN_END
        return ON_PART if self.part_present else CLOSED_END
