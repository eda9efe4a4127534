"""Translates what the process of the maker's library could not do to a numbered fault."""

from cellctl.errors.camera import (
    CameraAbsent,
    CameraBusy,
    CameraFeatureRefused,
    CameraOutOfReach,
    ImagesDamaged,
    ProducerUnusable,
    SeveralCameras,
)
from cellctl.errors.link import LinkError, LinkLost, ReplyTimeout
from drivers.camera.gige.protocol import RequestFailed, Trouble

_FAULTS: dict[Trouble, type[LinkError]] = {
    Trouble.ABSENT: CameraAbsent,
    Trouble.AMBIGUOUS: SeveralCameras,
    Trouble.SUBNET: CameraOutOfReach,
    Trouble.BUSY: CameraBusy,
    Trouble.PRODUCER: ProducerUnusable,
    Trouble.FEATURE: CameraFeatureRefused,
    Trouble.LOST: LinkLost,
    Trouble.SILENT: ReplyTimeout,
    Trouble.DAMAGED: ImagesDamaged,
}


def of(name: str, failed: RequestFailed) -> LinkError:
    """The fault of a request that was not carried out; ``name`` is that of the device."""
    return _FAULTS[failed.trouble](f"{name}: {failed.text}")
