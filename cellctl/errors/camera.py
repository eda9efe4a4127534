"""22x and 23x: cameras behind the library of their maker (GenTL)."""

from cellctl.errors.link import LinkError


class CameraError(LinkError):
    """Something about a camera that only its maker's library knows."""


class CameraAbsent(CameraError):
    """No producer sees the camera."""

    number = 221
    text = "Camera is not there"
    cause = "No power or cable, a mistyped name or number, or a firewall that drops its answers."
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


class CameraOutOfReach(CameraError):
    """The camera is seen, and its address is in another subnet than this PC's."""

    number = 227
    text = "Camera is in another subnet"
    cause = "Camera and network interface have addresses that do not belong together."
    remedy = "Give the camera an address of the interface's subnet by the maker's tool, or by DHCP."


class SeveralCameras(CameraError):
    """The cell file does not say which one of several cameras is meant."""

    number = 228
    text = "Several cameras have this name"
    cause = "A user name or address that two cameras have, or the serial number of two makers."
    remedy = "The detail names them; choose by another key, or give each a name of its own."


class ExposureNotReached(CameraError):
    """The automatic exposure has not found an image of the wanted grey."""

    number = 231
    text = "Automatic exposure has not reached its grey"
    cause = "Too much or too little light, no holes in view, or reflections beside them."
    remedy = "Change lamp or aperture; see what the camera sees by `cellctl focus`."


class ExposureNotAdjustable(CameraError):
    """The driver has no way to set the exposure of its camera."""

    number = 232
    text = "Exposure of this camera cannot be set from here"
    cause = "The protocol of its server has no request for it."
    remedy = "Set the exposure at the camera or its server."


class ImageRepeated(CameraError):
    """Two exposures have the same image, bit by bit: no sensor makes that."""

    number = 233
    text = "Camera repeats an image"
    cause = "A frame grabber, server or driver hands out an old buffer under a new number and time."
    remedy = "Switch the camera or its server off and on; if it comes again, exchange its driver."
