"""Where the server's status and the sockets' errors become numbered faults of the cell."""

from cellctl.errors.link import ConnectTimeout, DeviceFault, LinkError, LinkLost, ReplyTimeout
from drivers.camera.frame_server.protocol import Status

_WORDS = {
    Status.BUSY: "busy",
    Status.CAMERA_FAULT: "camera fault",
    Status.BAD_REQUEST: "request not understood",
}


def cannot_connect(peer: str, error: OSError) -> LinkError:
    """Fault of a connection that could not be made. ``TimeoutError`` is an ``OSError`` too."""
    return ConnectTimeout(f"{peer}: {error.strerror or 'no answer'}")


def broken(peer: str, error: Exception) -> LinkError:
    """Fault of a connection that ended in the middle of an exchange."""
    return LinkLost(f"{peer}: {error}")


def silent(peer: str, timeout_s: float) -> LinkError:
    """Fault of a reply that did not come."""
    return ReplyTimeout(f"{peer}: no complete reply within {timeout_s:g} s")


def refused(peer: str, status: Status) -> LinkError:
    """Fault of a status other than ok."""
    return DeviceFault(f"{peer}: {_WORDS[status]}")
