"""What the driver and the process of the maker's library say to each other.

All of it is plain: whatever checks a cell file would be loaded in that process too, and make each
start of it a third slower.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path


class Trouble(Enum):
    """Why the process could not do what it was asked."""

    ABSENT = "absent"
    """No producer sees such a camera."""
    AMBIGUOUS = "ambiguous"
    """Several cameras are what is asked for."""
    SUBNET = "subnet"
    """The camera is seen, and its address cannot be reached from this PC."""
    BUSY = "busy"
    """Another program controls the camera."""
    PRODUCER = "producer"
    """A producer is missing, or cannot be loaded."""
    FEATURE = "feature"
    """The camera does not have a feature, or refuses its value."""
    LOST = "lost"
    """The camera was open and does not answer any more."""
    SILENT = "silent"
    """No image came in time."""
    DAMAGED = "damaged"
    """Images came, and none of them whole and new."""


@dataclass(frozen=True, slots=True)
class SensorRegion:
    """The part of the sensor that is read out, px."""

    width: int
    height: int
    offset_x: int
    offset_y: int


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """How a camera is set up: what ``config.Acquisition`` says of each."""

    producers: tuple[Path, ...]
    trigger: str
    burst: int
    pixel_format: str
    exposure_s: float | None
    gain_db: float | None
    packet_bytes: int | None
    packet_delay_ticks: int | None
    region: SensorRegion | None
    features: Mapping[str, bool | int | float | str]
    connect_timeout_s: float
    image_timeout_s: float
    tries: int


@dataclass(frozen=True, slots=True)
class CameraSetup:
    """One camera and how it is set up."""

    keys: Mapping[str, str]
    """By what it is known, such as its ``serial_number``."""
    settings: CameraSettings


@dataclass(frozen=True, slots=True)
class OpenRequest:
    """Load the producers and open these cameras, in this order: that of their triggers.

    Producers and tries are those of the first.
    """

    cameras: tuple[CameraSetup, ...]


@dataclass(frozen=True, slots=True)
class GrabRequest:
    """Expose all cameras once."""

    released: tuple[int, ...] = ()
    """Blocks of earlier images that nobody in the daemon reads any more."""


@dataclass(frozen=True, slots=True)
class SetExposureRequest:
    """Expose for so long from now on; answered by ``Opened``."""

    exposure_s: float


@dataclass(frozen=True, slots=True)
class ListRequest:
    """What the producers see."""

    producers: tuple[Path, ...]
    """Without any, those of GENICAM_GENTL64_PATH."""


Request = OpenRequest | GrabRequest | SetExposureRequest | ListRequest


class CameraState(Enum):
    """Whether a camera can be opened, best first."""

    FREE = "free"
    OUT_OF_REACH = "other subnet"
    IN_USE = "in use"


@dataclass(frozen=True, slots=True)
class SeenCamera:
    """A camera that a producer sees; empty texts for what that does not say."""

    producer: str
    """File of the producer."""
    id: str
    vendor: str
    model: str
    serial_number: str
    user_name: str
    ip_address: str
    subnets: tuple[str, ...]
    """Networks of the interface that it is seen on: the PC's addresses there, with their lengths of
    mask."""
    state: CameraState


@dataclass(frozen=True, slots=True)
class OpenedCamera:
    """One camera as it was set up; None for what it does not say or sets by itself."""

    serial_number: str
    pixel_format: str
    """Name by PFNC; empty where the camera does not say it, or says it by a number that PFNC does
    not have."""
    exposure_s: float | None
    gain_db: float | None


@dataclass(frozen=True, slots=True)
class Opened:
    """All cameras are open, set up and acquire."""

    cameras: tuple[OpenedCamera, ...]


@dataclass(frozen=True, slots=True)
class SentImage:
    """One image; its bytes follow as a descriptor of anonymous memory."""

    block: int
    """What that memory is called when it is given back."""
    pixel_format: str
    width: int
    height: int
    size: int
    """Size in bytes."""
    device_time_ns: int
    """Time of the exposure by the camera's own clock."""
    trigger_s: float
    """Monotonic, when its trigger had been sent; of a camera that runs freely, when it was asked
    for, which is before its exposure; NaN for a wire, whose trigger this PC does not see."""
    time_s: float
    """Monotonic, when it was whole in this PC."""
    exposure_s: float | None = None
    """Length of this exposure, by its chunks; None where it has none that say so."""
    gain_db: float | None = None


@dataclass(frozen=True, slots=True)
class Grabbed:
    """One image of every camera."""

    images: tuple[SentImage, ...]
    taken_again: int
    """Exposures before this one, for the same request, of which an image was damaged or old."""


@dataclass(frozen=True, slots=True)
class CamerasSeen:
    """The answer to ``ListRequest``."""

    cameras: tuple[SeenCamera, ...]
    unusable: tuple[str, ...] = ()
    """Producers that could not be asked, and why."""


@dataclass(frozen=True, slots=True)
class RequestFailed:
    """The request was not carried out."""

    trouble: Trouble
    text: str


Answer = Opened | Grabbed | CamerasSeen | RequestFailed
