"""Whether a request may be obeyed in a state and mode: pure functions on the tables."""

from dataclasses import dataclass

from cellctl.packml.command import COMMANDS, Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.tables import MODE_CHANGE_IN, NOT_IN_MODE, ON_COMMAND


@dataclass(frozen=True, slots=True)
class Refusal:
    """One refused request, kept for the operator."""

    time_s: float
    """Monotonic."""
    mode: Mode
    state: State
    request: str
    code: RejectCode


def judge_command(state: State, mode: Mode, command: int) -> RejectCode:
    """Why a command is refused, NONE if it is not."""
    if command not in COMMANDS:
        return RejectCode.COMMAND_UNDEFINED
    target = ON_COMMAND.get((state, Command(command)))
    if target is None:
        return RejectCode.COMMAND_NOT_ALLOWED
    if target in NOT_IN_MODE[mode]:
        return RejectCode.STATE_NOT_IN_MODE
    return RejectCode.NONE


def judge_mode(state: State, mode: int) -> RejectCode:
    """Why a mode change is refused, NONE if it is not."""
    if not 1 <= mode <= 31:
        return RejectCode.MODE_UNDEFINED
    if mode not in NOT_IN_MODE:
        return RejectCode.MODE_NOT_CONFIGURED
    if state not in MODE_CHANGE_IN:
        return RejectCode.MODE_CHANGE_NOT_ALLOWED
    return RejectCode.NONE
