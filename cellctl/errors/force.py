"""5xx: force sensor, guard and mating."""

from cellctl.errors.base import CellError


class ForceError(CellError):
    """Force sensing or mating left its window."""
