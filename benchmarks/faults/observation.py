"""What was seen of one fault in one phase: values only, as they are kept in the results."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum


class Effect(StrEnum):
    """When a fault has to end all motion."""

    AT_ONCE = "at once"
    """All motion ends within the bound."""
    MOVE_ENDS = "move ends"
    """The move under way may go to its end; no other one begins."""
    AT_NEXT_USE = "at next use"
    """What does not use the thing that failed may go on; the job does not end well."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What is demanded of the controller."""

    effect: Effect
    bound_s: float
    """All motion has ended so long after the fault; see ``Effect``."""
    peak_bound_n: float
    """No contact force after the fault is greater."""
    line_silent: bool = False
    """The daemon is dead: the line sees nothing at all."""
    may_restart: bool = False
    """Clear and Reset alone do not help: the daemon has to be started again."""
    noticed_s: float = 0.0
    """Nobody can know of the fault earlier: until then other moves may begin."""
    has_record: bool = True
    """The job has a record that must be closed."""


@dataclass(frozen=True, slots=True)
class Moved:
    """A motion after the fault; times in seconds after it."""

    arm: str
    begun_s: float
    ended_s: float | None
    travel_mm: float
    rise_mm: float
    turn_deg: float


@dataclass(frozen=True, slots=True)
class Observation:
    """Everything that was seen."""

    fault: str
    phase: str
    expected: Expected
    motions: Sequence[Moved]
    peak_n: float
    """Greatest contact force from the fault on."""
    ended_s: float | None
    """When the line saw the state that it ended in; None if it saw none."""
    state: str
    """That state, or the last one that was seen."""
    shown: Sequence[int]
    """Numbers of the alarms that the line saw."""
    refused: int
    """Reject code of a Start that was given with the fault; 0 where it was taken."""
    record: str | None
    """How the record of the job ended; "open" while it is; None where there is no record."""
    next_start: str
    """What the next start found."""
    idle_again: bool
    """The cell came back to Idle by Clear and Reset, as an operator would do it."""
    restarted: bool
    """It did so only after the daemon had been started again."""
    lost_s: float
    """Time that the PC did not give to the fake world."""
    software: str
    """Version and revision that were tried."""

    @property
    def key(self) -> str:
        """Name of the cell of the table."""
        return f"{self.fault}/{self.phase}"
