"""Unit modes, with the numbers of ISA-TR88.00.02."""

from enum import IntEnum


class Mode(IntEnum):
    """The standard leaves 4 to 31 to the manufacturer; this unit has none of its own."""

    INVALID = 0
    PRODUCTION = 1
    """A process runs on a part."""
    MAINTENANCE = 2
    """Calibration, identification, verification: the recipe number selects the procedure."""
    MANUAL = 3
    """Set-up at the robots' own panels; this cell arms and moves nothing."""
