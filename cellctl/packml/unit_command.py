"""One command to the unit, in the same form whoever gives it."""

from dataclasses import dataclass, field, replace
from enum import IntFlag, StrEnum
from typing import Self

from cellctl.clock import now_s
from cellctl.packml.command import Command


class Source(StrEnum):
    """Through which interface a command arrives. A further API adds one member here."""

    LINE = "line"
    """The line PLC. It alone commands motion while it is alive and the unit is in Production."""
    TERMINAL = "terminal"
    """An operator at the cell's own PC."""
    PAGE = "page"
    """A person who has signed in on the operator page."""


class Options(IntFlag):
    """How a part is made. Bits that are not named here are kept, so that they can be refused."""

    NONE = 0
    DRY_RUN = 0b01
    SINGLE_STEP = 0b10


KNOWN_OPTIONS = Options.DRY_RUN | Options.SINGLE_STEP


MOST_AGE_S = 10.0
"""What may move a robot is not begun when it was given longer ago. A daemon that stood still finds
commands in its sockets; whoever gave them was told that nobody has answered, and may be in the
cell."""


@dataclass(frozen=True, slots=True)
class UnitCommand:
    """What somebody asks of the unit. Nothing in it has been validated yet.

    Modes, command, recipe and options are plain numbers for that reason: an unknown number has to
    reach the validator, which refuses it with its code. 0 (or an empty text) means "not asked for".
    """

    source: Source
    person: str = ""
    """Who asks, as the interface knows them: a user, a person at a page, the line's address."""
    cntrl_cmd: int = Command.UNDEFINED
    """Number of a ``Command``: CntrlCmd of the PackTags."""
    unit_mode: int = 0
    """Number of the ``Mode`` that is asked for; 0 leaves the mode as it is."""
    in_mode: int = 0
    """Number of the ``Mode`` in which alone the command is meant; 0 for any. Changes nothing."""
    recipe_id: int = 0
    """Recipe in Production, procedure in Maintenance."""
    options: Options = Options.NONE
    serial: str = ""
    """Serial number of the part."""
    mate_serial: str = ""
    """Serial number of the part that it is joined to; empty where nobody names it."""
    order: str = ""
    """Operator or order, as the caller names it; never who has asked."""
    alarm_ack_id: int = 0
    """Fault number of the alarm to acknowledge."""
    alarms_seen: int = 0
    """How many alarms of that number were seen, the oldest first; 0 acknowledges all."""
    arrived_s: float = field(default_factory=now_s, compare=False)
    """Monotonic time in seconds at which the command was given."""

    @property
    def who(self) -> str:
        """Who asks, for the audit log; never empty, and never what the caller has typed."""
        return f"{self.source}:{self.person}" if self.person else str(self.source)

    @property
    def operator(self) -> str:
        """Who or what is recorded with a run; empty when the line names nobody."""
        return self.order or ("" if self.source is Source.LINE else self.who)

    @property
    def dry_run(self) -> bool:
        """Whether the part is only measured and corrected, never mated."""
        return bool(self.options & Options.DRY_RUN)

    @property
    def single_step(self) -> bool:
        """Whether the unit is held after each step."""
        return bool(self.options & Options.SINGLE_STEP)

    @property
    def ends_motion(self) -> bool:
        """True for Stop and Abort, which are executed whatever else is wrong with the command."""
        return self.cntrl_cmd in (Command.STOP, Command.ABORT)

    @property
    def only_halts(self) -> bool:
        """True for the commands that start nothing: Stop and Abort, Hold and Suspend."""
        return self.ends_motion or self.cntrl_cmd in (Command.HOLD, Command.SUSPEND)

    def given_at(self, given_s: float) -> Self:
        """The command with the monotonic time (s) at which somebody gave it, which may be long ago
        in a daemon that stood still. A Stop or an Abort counts from now on: it ends what was given
        before."""
        if self.ends_motion:
            return self
        return replace(self, arrived_s=min(given_s, self.arrived_s))
