"""Faults that a fake frame server can be told to have, by name."""

from typing import Final

from fakes.render.image_faults import PICTURE_FAULTS, SCENE_FAULTS

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


class FrameFaults:
    """Faults of one head, injected by name; a name that does not exist is a ``ValueError``."""

    NAMES: Final = (*WIRE_FAULTS, *SCENE_FAULTS, *PICTURE_FAULTS)

    def __init__(self) -> None:
        self._values: dict[str, float] = {}
        self._replies_left: dict[str, int] = {}

    def inject(self, name: str, value: float = 1.0, *, replies: int | None = None) -> None:
        """Switch a fault on, until ``clear`` or for the next ``replies`` grabs."""
        if name not in self.NAMES:
            raise ValueError(f"no such fault: {name}; there are {', '.join(self.NAMES)}")
        self._values[name] = value
        self._replies_left.pop(name, None)
        if replies is not None:
            self._replies_left[name] = replies

    def clear(self, name: str | None = None) -> None:
        """Switch one fault, or all of them, off."""
        for key in [name] if name is not None else list(self._values):
            self._values.pop(key, None)
            self._replies_left.pop(key, None)

    def take(self) -> dict[str, float]:
        """Faults of the reply that is due now, with their values."""
        active = dict(self._values)
        for name in active:
            if name in self._replies_left:
                self._replies_left[name] -= 1
                if self._replies_left[name] <= 0:
                    self.clear(name)
        return active
