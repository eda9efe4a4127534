"""The result of a command: the number that the line PLC reads in `result`."""

from enum import IntEnum


class Result(IntEnum):
    """How the command with the number ``done_seq`` has ended."""

    NONE = 0
    """It has not ended yet."""
    GOOD = 1
    """Done; for Start: the part is good."""
    BAD = 2
    """Start ended in Completed and the part is not good."""
    REJECTED = 3
    """It was not begun; ``reject_code`` says why."""
    STOPPED = 4
    ABORTED = 5
    IGNORED = 6
    """It stood in the registers when the cell started, and was not executed."""
