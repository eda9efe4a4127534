"""Every check that a command meets, in the order in which it meets them.

The first check that fails gives the reject code. Stop and Abort meet only checks 7 and 8.

1. Link: a client whose link is dead may only end motion (``Submission.link_fault``).
2. Parameters: serial number, order and options are well formed.
3. Turn: no Stop, and no command of another source, came between giving and executing the command,
   and what may move a robot was not given too long ago.
4. Authority: the line PLC alone commands motion in Production while it is alive.
5. Mode: a command that is meant for one mode is not carried out in another.
6. Start: recipe or procedure, calibrations, records and devices (``runtime.jobs.factory``).
7. Tables: the state and the mode allow the command (``packml.validation``).
8. Devices are connected (the gate of the state machine).

The arbiter asks for 1 to 6 before it queues for execution, because 6 reads files. It asks for 3 to
5 again right before execution: while 6 waited for the disk a Stop may have come, the line may have
come alive, or somebody may have changed the mode. 7 and 8 belong to the state machine, which asks
them whoever commands it.
"""

import math
import re
from collections.abc import Callable

from cellctl.clock import now_s
from cellctl.command.submission import Submission
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.unit_command import KNOWN_OPTIONS, MOST_AGE_S, Source, UnitCommand
from cellctl.packml.validation import validate_command, validate_mode
from cellctl.runtime.jobs.factory import JobFactory
from cellctl.runtime.unit import MAY_MOVE

_CHARSET = re.compile(r"[A-Z0-9._-]*")
"""What fits into the line's text registers and into a file name on any system."""


def validate_parameters(command: UnitCommand) -> RejectCode:
    """What is wrong with the texts and option bits in themselves; NONE for Stop and Abort."""
    if command.ends_motion:
        return RejectCode.NONE
    # Only a Start names a part. A PLC may leave anything well formed in the register otherwise.
    serial_missing = command.cntrl_cmd == Command.START and not command.serial
    serials = (command.serial, command.mate_serial)
    if serial_missing or not all(_CHARSET.fullmatch(serial) for serial in serials):
        return RejectCode.SERIAL_INVALID
    if not _CHARSET.fullmatch(command.order):
        return RejectCode.ORDER_INVALID
    if command.options | KNOWN_OPTIONS != KNOWN_OPTIONS:
        return RejectCode.OPTIONS_UNKNOWN
    return RejectCode.NONE


def line_in_control(mode: Mode, *, line_alive: bool) -> bool:
    """Whether the line PLC alone may move the cell: its heartbeat is present in Production."""
    return line_alive and mode is Mode.PRODUCTION


def validate_authority(command: UnitCommand, mode: Mode, *, line_alive: bool) -> RejectCode:
    """Why a command has to be left to the line PLC; NONE for the line's own commands.

    Left to the line is what may move the cell in Production, and a change of mode out of
    Production. Everybody may end motion, release a fault or acknowledge an alarm.
    """
    if command.source is Source.LINE or not line_alive:
        return RejectCode.NONE
    # A command may bring its mode with it: what would start Production counts as motion in
    # Production.
    wanted = command.unit_mode or command.in_mode or mode
    moves = command.cntrl_cmd in MAY_MOVE and Mode.PRODUCTION in (mode, wanted)
    leaves_production = line_in_control(mode, line_alive=line_alive) and wanted != mode
    return RejectCode.LINE_IN_CONTROL if moves or leaves_production else RejectCode.NONE


def validate_in_mode(command: UnitCommand, mode: Mode, state: State) -> RejectCode:
    """Why a command that is meant for one mode is refused in this one; NONE where it may go on.

    A Start at the terminal says what shall run. It does not say that the mode may change, which
    decides about speeds and about who may command.
    """
    if command.in_mode in (0, mode):
        return RejectCode.NONE
    # A state that refuses the command in any mode is the truer reason: another mode would not help.
    return validate_command(state, Mode(command.in_mode), command.cntrl_cmd) or (
        RejectCode.OTHER_MODE
    )


def validate_in_new_mode(command: UnitCommand, state: State) -> RejectCode:
    """Why a command that also changes the mode would be refused after the change.

    A command that is refused must leave the mode as it was, so this is asked before the change.
    A mode that is itself refused gets its code from the state machine.
    """
    if command.cntrl_cmd == Command.UNDEFINED or validate_mode(state, command.unit_mode):
        return RejectCode.NONE
    return validate_command(state, Mode(command.unit_mode), command.cntrl_cmd)


def start_mode(command: UnitCommand, machine: PackMLMachine) -> Mode | None:
    """The mode in which a Start would begin.

    None for other commands, and for a Start that the tables refuse by its state or mode anyway.
    """
    if command.cntrl_cmd != Command.START or machine.state is not State.IDLE:
        return None
    try:
        return Mode(command.unit_mode or machine.mode)
    except ValueError:
        return None


class CommandValidator:
    """Checks 1 to 6, and the times that check 3 needs."""

    def __init__(
        self, machine: PackMLMachine, jobs: JobFactory, line_alive: Callable[[], bool]
    ) -> None:
        self._machine = machine
        self._jobs = jobs
        self._line_alive = line_alive
        self._stopped_s = -math.inf
        """Monotonic time at which the last Stop or Abort was given."""
        self._executed_s = dict.fromkeys(Source, -math.inf)
        """Monotonic time at which the last command of each source was executed."""

    def validate(self, submission: Submission) -> RejectCode:
        """Checks 1 to 5: everything that needs no disk."""
        command = submission.command
        return (
            submission.link_fault() or validate_parameters(command) or self.validate_turn(command)
        )

    def validate_turn(self, command: UnitCommand) -> RejectCode:
        """Checks 3 to 5: whether it is still the turn of whoever gave the command."""
        others = (time_s for source, time_s in self._executed_s.items() if source != command.source)
        # Whoever gave a command before one of these happened did not know of it, and might have
        # decided otherwise. Their own earlier commands, however, they do know.
        if command.arrived_s < max(self._stopped_s, *others):
            return RejectCode.SUPERSEDED
        if command.cntrl_cmd in MAY_MOVE and now_s() - command.arrived_s > MOST_AGE_S:
            return RejectCode.SUPERSEDED
        mode, state = self._machine.mode, self._machine.state
        authority = validate_authority(command, mode, line_alive=self._line_alive())
        return authority or validate_in_mode(command, mode, state)

    async def validate_start(self, command: UnitCommand) -> RejectCode:
        """Check 6; NONE for other commands. Reads files and the run store."""
        mode = start_mode(command, self._machine)
        return RejectCode.NONE if mode is None else await self._jobs.validate(command, mode)

    def executed(self, command: UnitCommand) -> None:
        """Take note of a command that is being executed."""
        if command.ends_motion:
            self._stopped_s = max(self._stopped_s, command.arrived_s)
        self._executed_s[command.source] = now_s()
