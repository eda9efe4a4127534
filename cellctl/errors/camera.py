"""22x: cameras behind the library of their maker (GenTL)."""

from cellctl.errors.link import LinkError


class CameraError(LinkError):
    """Something about a camera that only its maker's library knows."""


class CameraAbsent(CameraError):
    """No producer sees the camera."""

    number = 221
    text = "Camera is not there"
    cause = "No power, cable, another subnet than this PC's, or a mistyped serial number."
    remedy = "The detail names the cameras that are seen; the maker's tool shows other subnets too."


class CameraBusy(CameraError):
    """Another program controls the camera."""

    number = 222
    text = "Camera is in use by another program"
    cause = "The maker's viewer or another cellctl has it open, here or on another PC."
    remedy = "Close the other program. A camera whose program has died is free after its heartbeat."


class ProducerUnusable(CameraError):
    """The maker's library is missing or cannot be loaded."""

    number = 223
    text = "GenTL producer cannot be used"
    cause = "Not installed, another path, or made for another processor or operating system."
    remedy = "Install the maker's producer (.cti) for this PC and name it in the cell file."


class CameraFeatureRefused(CameraError):
    """A setting of the cell file that the camera does not take."""

    number = 224
    text = "Camera refuses a setting"
    cause = "The camera has no such feature, or not this value of it."
    remedy = "See the detail for what the camera allows; correct the settings in the cell file."


class ImagesDamaged(CameraError):
    """Images came, but none of them whole and new."""

    number = 225
    text = "Camera sends damaged images"
    cause = "Packets are lost: cable, switch, load, or packets too large for the network."
    remedy = "Set jumbo frames on all of the way, or a smaller packet size and more packet delay."


class CamerasNotTogether(CameraError):
    """The cameras of a head did not expose at the same time."""

    number = 226
    text = "Cameras of a head did not expose together"
    cause = "A busy PC or network delayed one trigger, or one camera missed it."
    remedy = "Look at the PC's load and the network; a wire between the cameras triggers both."
