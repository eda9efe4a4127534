"""2xx: connections to devices."""

from cellctl.errors.base import CellError, Reaction


class LinkError(CellError):
    """Something between this PC and a device."""


class ConnectTimeout(LinkError):
    """The device never answered while connecting."""

    number = 201
    text = "Device does not answer"
    cause = "Device off, cable, wrong address or port, or its program is not running."
    remedy = "Check power, cable and the address in the cell file; then Clear and Reset."


class LinkLost(LinkError):
    """An established connection broke or went silent."""

    number = 202
    text = "Connection to a device lost"
    cause = "Cable, switch, device restart, or its program stopped."
    remedy = "Find out why before clearing; the cell re-measures before it moves again."


class ProtocolViolation(LinkError):
    """The peer sent something its protocol does not allow."""

    number = 203
    text = "Device sent invalid data"
    cause = "Wrong device or firmware on this port, electrical noise, or a software fault."
    remedy = "Compare device, firmware and job version with the driver's README."


class VersionMismatch(LinkError):
    """Peer speaks another version of the protocol, or another convention."""

    number = 204
    text = "Device protocol version or convention does not match"
    cause = "Job program or firmware older or newer than this driver, or another robot or "
    cause += "convention than the cell file says; see the detail."
    remedy = "Correct name, port or convention in the cell file or on the device, or load the job "
    remedy += "program that belongs to this cellctl version."


class ReplyTimeout(LinkError):
    """A request was sent and no reply came in time."""

    number = 205
    text = "Device did not reply in time"
    cause = "Device busy, hung, or the link is half open."
    remedy = "Check the device; then Clear and Reset."


class PortInUse(LinkError):
    """A listening port of this PC is taken."""

    number = 206
    text = "A network port of this PC is already in use"
    cause = "Another cellctl or another program listens there."
    remedy = "Stop the other program or change the port in the cell file."
    reaction = Reaction.STOP


class StaleData(LinkError):
    """The newest value is older than its reader allows."""

    number = 207
    text = "Data from a device is too old"
    cause = "The device stopped sending although its connection stands."
    remedy = "Check the device's program and load; then Clear and Reset."


class CallerRefused(LinkError):
    """Somebody who is not the device called on its port."""

    number = 212
    text = "A stranger called on the port of a device and was refused"
    cause = (
        "Another controller with wrong settings, or a program that should not be in this network."
    )
    remedy = (
        "Find the caller by its address; correct the device's address in the cell file if it moved."
    )
    reaction = Reaction.WARN


class DeviceFault(LinkError):
    """A device answered, but with a fault of its own."""

    number = 208
    text = "Device reports a fault of its own"
    cause = "See the device's words in the detail."
    remedy = "Put the device in order as its maker says; then Clear and Reset."


class DeviceAway(LinkError):
    """A head or the tracker does not answer while the cell rests."""

    number = 209
    text = "A measuring device does not answer"
    cause = "See the fault of the device in the detail."
    remedy = "Bring the device back; Start is refused until it answers."
    reaction = Reaction.WARN
