"""6xx: calibration and its gate."""

from cellctl.errors.base import CellError


class CalibrationError(CellError):
    """A calibration failed or may not be used."""
