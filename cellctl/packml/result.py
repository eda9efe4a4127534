"""The result of a command: the number that the line PLC reads in `result`."""

from enum import IntEnum


class Result(IntEnum):
    """Belongs to the command with the number ``done_seq``."""

    NONE = 0
    """Not ended."""
    GOOD = 1
    """Done; for Start: the part is good."""
    BAD = 2
    """Start ended in Completed and the part is not good."""
    REJECTED = 3
    """Not begun, see ``reject_code``."""
    STOPPED = 4
    ABORTED = 5
    IGNORED = 6
    """Stood in the registers when the cell started."""
