"""Faults that a fake frame server can be told to have, by name."""

from typing import Final

from fakes.render.image_faults import PICTURE_FAULTS, SCENE_FAULTS
from fakes.wire.named_faults import NamedFaults

WIRE_FAULTS: Final[dict[str, str]] = {
    "silent": "the request is read and never answered",
    "half_open": "the connection stands, but nothing more is read or written on it",
    "hang_up": "the connection is closed in place of a reply",
    "late": "the reply comes so many seconds late (value)",
    "dribbled": "the reply comes in pieces of so many bytes (value) with pauses between",
    "corrupt_payload": "one bit of the image is flipped, its CRC is that of the true one",
    "corrupt_header": "one bit of the header is flipped",
    "truncated": "the connection ends in the middle of the payload",
    "wrong_size": "a quarter of the image, in a reply that is consistent",
    "wrong_id": "the reply carries another request's id",
    "busy": "status 1",
    "camera_fault": "status 2",
    "frozen": "image, frame id and time stamp of the last pair, again and again",
}


class FrameFaults(NamedFaults):
    """Faults of one head or camera; a reply is the answer to a grab."""

    NAMES: Final = (*WIRE_FAULTS, *SCENE_FAULTS, *PICTURE_FAULTS)

    def __init__(self) -> None:
        super().__init__(self.NAMES)
