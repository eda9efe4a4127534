"""1xx: configuration, files and arguments."""

from cellctl.errors.base import CellError, Reaction


class ConfigError(CellError):
    """What the user wrote is wrong."""

    reaction = Reaction.STOP


class ConfigUnreadable(ConfigError):
    """The cell file cannot be read or is not TOML."""

    number = 101
    text = "Configuration file cannot be read"
    cause = "Missing file, no permission, or a syntax error in the TOML."
    remedy = "See the line and column in the detail."


class ConfigInvalid(ConfigError):
    """Keys or values of the cell file are not allowed."""

    number = 102
    text = "Configuration is not valid"
    cause = "Unknown or missing keys, or values outside their range."
    remedy = "Run `cellctl check FILE`: it lists every error with the allowed range."


class UnknownDriver(ConfigError):
    """A driver named in the cell file is not installed."""

    number = 103
    text = "Driver is not available"
    cause = "Misspelt name, or the package that holds the driver or its vendor SDK is missing."
    remedy = "Use one of the names in the detail or install the driver."


class MixedSimulation(ConfigError):
    """Real and simulated devices in one cell."""

    number = 104
    text = "Real and simulated devices are mixed"
    cause = "Some devices are marked `simulated = true` and others are not."
    remedy = "Mark all devices of a simulated cell, or none."


class DeviceNotInCell(ConfigError):
    """A command names a device that the cell file does not have."""

    number = 106
    text = "Device is not in the cell file"
    cause = "Misspelt name, another kind of device, or another cell file."
    remedy = "Use one of the names in the detail."


class FileInvalid(ConfigError):
    """A file given to a command is not what it should be."""

    number = 105
    text = "Input file is not valid"
    cause = "Wrong file, wrong format, or damaged content."
    remedy = "See the detail for the place in the file."
