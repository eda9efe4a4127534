"""The cameras that the fake GenTL producer shows, in a file that both have mapped.

The layout is that of ``shared_state`` in ``producer/camera.h``. A camera draws images of its own,
of which each pixel is known: see ``expected_image``. Or it looks into a fake cell, which exposes
where ``images`` says: see ``fakes.gentl.exposures``.
"""

import mmap
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from ipaddress import IPv4Address
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from fakes.gentl.formats import PFNC, Format

ENVIRONMENT = "FAKE_GENTL_STATE"
"""Names the file to the producer."""

_MAGIC = 0x46474331
_HEADER_BYTES = 256
_CAMERAS = 8
_TEXT_BYTES = 64
_ADDRESS_BYTES = 64
_WORDS = (
    "present", "width", "height", "pixel_format", "exposures", "drop", "lost", "incomplete",
    "stale", "slow_ms", "hang", "crash", "busy", "opened", "buffers",
    "pulses", "wired_to", "strobes", "losses", "address", "truncated",
)  # fmt: skip
_RESERVED_WORDS = 11
_CAMERA_BYTES = 4 * (len(_WORDS) + _RESERVED_WORDS) + 2 * _TEXT_BYTES

Fault = Literal[
    "drop", "lost", "incomplete", "truncated", "stale", "slow_ms", "hang", "crash", "busy"
]


@dataclass(frozen=True, slots=True)
class FakeCamera:
    """One camera on the fake network."""

    serial: str
    user_id: str = ""
    width: int = 640
    height: int = 480
    pixel_format: Format = "Mono8"
    address: str = "192.168.10.21"
    """The interface is 192.168.10.1/24; a camera of another subnet is seen and out of reach."""


class FakeCameras:
    """A file of cameras; a context that unmaps it."""

    def __init__(self, path: Path, cameras: Sequence[FakeCamera], images: str = "") -> None:
        """``images`` is the address of the fake cell that exposes; without one, cameras draw."""
        if not 0 < len(cameras) <= _CAMERAS:
            raise ValueError(f"1 to {_CAMERAS} cameras, not {len(cameras)}")
        self.path = path
        self._index = {camera.serial: number for number, camera in enumerate(cameras)}
        path.write_bytes(bytes(_HEADER_BYTES + _CAMERAS * _CAMERA_BYTES))
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), 0)
        header = (_MAGIC, len(cameras), images.encode())
        struct.pack_into(f"<II{_ADDRESS_BYTES}s", self._memory, 0, *header)
        for camera in cameras:
            self._put(camera.serial, "width", camera.width)
            self._put(camera.serial, "height", camera.height)
            self._put(camera.serial, "pixel_format", PFNC[camera.pixel_format])
            self._put(camera.serial, "address", int(IPv4Address(camera.address)))
            texts = self._at(camera.serial) + _CAMERA_BYTES - 2 * _TEXT_BYTES
            struct.pack_into(
                f"{_TEXT_BYTES}s{_TEXT_BYTES}s",
                self._memory,
                texts,
                camera.serial.encode(),
                camera.user_id.encode(),
            )
            self._put(camera.serial, "present", 1)

    def inject(self, serial: str, fault: Fault, amount: int = 1) -> None:
        """Have something go wrong; 0 puts it right. See ``camera.h`` for what each amount means."""
        if fault == "lost" and amount:
            self._put(serial, "losses", self._get(serial, "losses") + 1)
        self._put(serial, fault, amount)

    def pulse(self) -> None:
        """A pulse on Line1 of all cameras that are not wired to another one."""
        for serial in self._index:
            self._put(serial, "pulses", self._get(serial, "pulses") + 1)

    def wire(self, output: str, to: str) -> None:
        """Lead the exposure output of one camera to Line1 of another; both by serial number."""
        self._put(to, "wired_to", self._index[output] + 1)

    def exposures(self, serial: str) -> int:
        """Images that a camera has exposed since the file was made."""
        return self._get(serial, "exposures")

    def begun(self, serial: str) -> int:
        """Exposures that a camera has begun since the file was made, whatever became of them."""
        return self._get(serial, "strobes")

    def opened(self, serial: str) -> int:
        """The process that controls a camera, 0 for none."""
        return self._get(serial, "opened")

    def buffers(self, serial: str) -> int:
        """Buffers that are announced to the camera's stream."""
        return self._get(serial, "buffers")

    def close(self) -> None:
        """Unmap the file."""
        self._memory.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def _at(self, serial: str, word: str = "present") -> int:
        return _HEADER_BYTES + self._index[serial] * _CAMERA_BYTES + 4 * _WORDS.index(word)

    def _put(self, serial: str, word: str, value: int) -> None:
        struct.pack_into("<I", self._memory, self._at(serial, word), value)

    def _get(self, serial: str, word: str) -> int:
        (value,) = struct.unpack_from("<I", self._memory, self._at(serial, word))
        return int(value)


def expected_image(
    frame_id: int, width: int, height: int, pixel_format: Format, *, camera: int = 0
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """What a camera, by its place in the file, draws into an image; shape (height, width)."""
    y, x = np.mgrid[0:height, 0:width].astype(np.int64)
    level = x + 3 * y + 37 * frame_id + 11 * camera
    if pixel_format.startswith(("Mono12", "BayerRG12")):
        return np.asarray((16 * level + 5) & 0x0FFF, dtype=np.uint16)
    return np.asarray(level & 0xFF, dtype=np.uint8)
