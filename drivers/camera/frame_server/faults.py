"""Translates the server's status to a numbered fault of the cell."""

from cellctl.errors.link import DeviceFault, LinkError
from drivers.camera.frame_server.protocol import ServerStatus

_WORDS = {
    ServerStatus.BUSY: "busy",
    ServerStatus.CAMERA_FAULT: "camera fault",
    ServerStatus.BAD_REQUEST: "request not understood",
}


def refused(peer: str, status: ServerStatus) -> LinkError:
    """Fault of a status other than ok."""
    return DeviceFault(f"{peer}: {_WORDS[status]}")
