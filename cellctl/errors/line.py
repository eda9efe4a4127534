"""7xx: the line PLC and commands."""

from cellctl.errors.base import CellError


class LineError(CellError):
    """The line asked for something that cannot be done, or vanished."""
