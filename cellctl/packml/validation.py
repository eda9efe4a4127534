"""Whether the tables allow a command or a mode in a given state: pure functions.

The state machine asks them for itself. The command path asks them early as well, so that a command
which would be refused in its new mode does not change the mode first.
"""

from dataclasses import dataclass

from cellctl.packml.command import COMMANDS, Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.transition_tables import MODE_CHANGE_IN, NOT_IN_MODE, ON_COMMAND

MODE_REQUEST = 0x100
"""Added to the number of a mode, so that it is no command."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """One refused command or mode change, kept for the operator."""

    time_s: float
    """Monotonic."""
    mode: Mode
    state: State
    request: str
    code: RejectCode
    number: int = 0
    """Number of the command that was refused, or ``MODE_REQUEST`` plus that of the mode."""


def validate_command(state: State, mode: Mode, command: int) -> RejectCode:
    """Why a command is refused in this state and mode; NONE when it is not."""
    if command not in COMMANDS:
        return RejectCode.COMMAND_UNDEFINED
    target = ON_COMMAND.get((state, Command(command)))
    if target is None:
        return RejectCode.COMMAND_NOT_ALLOWED
    if target in NOT_IN_MODE[mode]:
        return RejectCode.STATE_NOT_IN_MODE
    return RejectCode.NONE


def validate_mode(state: State, mode: int) -> RejectCode:
    """Why a change to this mode is refused in this state; NONE when it is not."""
    # The standard keeps 1 to 31 for modes. A number outside is no mode at all; one inside that the
    # tables do not name is a mode of other machines. The PLC programmer needs to tell them apart.
    if not 1 <= mode <= 31:
        return RejectCode.MODE_UNDEFINED
    if mode not in NOT_IN_MODE:
        return RejectCode.MODE_NOT_CONFIGURED
    if state not in MODE_CHANGE_IN:
        return RejectCode.MODE_CHANGE_NOT_ALLOWED
    return RejectCode.NONE
