"""Unit modes, with the numbers of ISA-TR88.00.02."""

from enum import IntEnum


class Mode(IntEnum):
    """4 to 31 would be free for own modes; this cell has none."""

    INVALID = 0
    PRODUCTION = 1
    """Assembly."""
    MAINTENANCE = 2
    """Calibration, identification, verification: the recipe number selects the procedure."""
    MANUAL = 3
    """Set-up at the robots' own panels; this cell arms and moves nothing."""
