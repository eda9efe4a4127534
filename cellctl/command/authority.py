"""Who may command: line PLC and terminal share the cell, and one of them at a time moves it."""

from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import UnitCommand
from cellctl.runtime.unit import MAY_MOVE


def line_in_control(mode: Mode, *, line_alive: bool) -> bool:
    """The line is in control while its PLC's heartbeat lives in Production."""
    return line_alive and mode is Mode.PRODUCTION


def judge_authority(command: UnitCommand, mode: Mode, *, line_alive: bool) -> RejectCode:
    """Why a command of the terminal has to be left to the line; NONE for the line's own.

    Left to it is what may move the cell in Production and what would take Production from it.
    What only ends motion, releases a fault or acknowledges an alarm is anybody's.
    """
    if not command.local or not line_alive:
        return RejectCode.NONE
    wanted = command.unit_mode or mode
    moves = command.cntrl_cmd in MAY_MOVE and Mode.PRODUCTION in (mode, wanted)
    takes = mode is Mode.PRODUCTION and wanted != mode
    return RejectCode.LINE_IN_CONTROL if moves or takes else RejectCode.NONE
