"""Translates the server's status to a numbered fault of the cell."""

from cellctl.errors.link import DeviceFault, LinkError
from drivers.camera.frame_server.protocol import Status

_WORDS = {
    Status.BUSY: "busy",
    Status.CAMERA_FAULT: "camera fault",
    Status.BAD_REQUEST: "request not understood",
}


def refused(peer: str, status: Status) -> LinkError:
    """Fault of a status other than ok."""
    return DeviceFault(f"{peer}: {_WORDS[status]}")
