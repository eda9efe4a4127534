"""1xx: configuration, files and arguments."""

from cellctl.errors.base import CellError


class ConfigError(CellError):
    """What the user wrote is wrong."""
