"""Who had what command taken, for whoever finds the cell otherwise than they left it."""

from dataclasses import dataclass
from datetime import UTC, datetime

from cellctl.packml.command import COMMAND_NAMES, Command
from cellctl.packml.mode import Mode
from cellctl.packml.unit_command import UnitCommand


@dataclass(frozen=True, slots=True)
class TakenCommand:
    """A command that is being executed or has been."""

    who: str
    name: str
    """As in the API, such as "hold"."""
    time: datetime

    @staticmethod
    def of(command: UnitCommand) -> "TakenCommand":
        """The command, taken at this moment."""
        return TakenCommand(command.who, _name(command), datetime.now(UTC))


def _name(command: UnitCommand) -> str:
    if command.cntrl_cmd == Command.START and command.in_mode == Mode.MAINTENANCE:
        return "procedure"
    given = COMMAND_NAMES.get(command.cntrl_cmd, "")
    return given or ("mode" if command.unit_mode else "acknowledge")
