"""Commands to a unit, with the numbers of ISA-TR88.00.02 (2022 edition)."""

from enum import IntEnum


class Command(IntEnum):
    """Values of CntrlCmd. COMPLETE came with the 2022 edition."""

    UNDEFINED = 0
    RESET = 1
    START = 2
    STOP = 3
    HOLD = 4
    UNHOLD = 5
    SUSPEND = 6
    UNSUSPEND = 7
    ABORT = 8
    CLEAR = 9
    COMPLETE = 10


COMMANDS = tuple(command for command in Command if command is not Command.UNDEFINED)
"""The 10 commands of the standard, without UNDEFINED."""

COMMAND_NAMES = {int(command): command.name.lower() for command in COMMANDS}
"""The word for each command by its number, as in the API and in records."""
