"""Translates an error that the server reports to a numbered fault of the cell."""

from cellctl.errors.link import DeviceFault, LinkError


def reported(message: object) -> LinkError:
    """Fault of a reply with status error."""
    return DeviceFault(str(message)[:160])
