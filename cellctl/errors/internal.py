"""9xx: faults of cellctl itself."""

from cellctl.errors.base import CellError


class InternalError(CellError):
    """A fault of the software."""
