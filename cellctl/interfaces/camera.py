"""A single camera, grey or colour: one image an exposure."""

from abc import abstractmethod
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.device import Device
from cellctl.interfaces.exposure import AdjustableExposure, ExposureRecord


class PixelFormat(Enum):
    """How the samples of an image are laid out; the names are those of the GenICam convention."""

    MONO8 = "Mono8"
    """Grey, 8 bit: uint8, shape (height, width)."""
    MONO16 = "Mono16"
    """Grey, 16 bit: uint16, shape (height, width). Cameras of 10 to 14 bit use the low bits."""
    RGB8 = "RGB8"
    """Colour, 8 bit a channel: uint8, shape (height, width, 3), red first."""
    RGB16 = "RGB16"
    """Colour, 16 bit a channel: uint16, shape (height, width, 3), red first. Cameras of 10 to 14
    bit use the low bits."""


# Without ``eq``: comparing two images would compare arrays, which has no single answer.
@dataclass(frozen=True, slots=True, eq=False)
class CameraImage:
    """One image of one exposure."""

    pixels: NDArray[np.uint8] | NDArray[np.uint16]
    """Shape and type follow from ``pixel_format``; row 0 is the top, pixel centres lie at integers.
    The array may be read-only."""
    pixel_format: PixelFormat
    time_s: float
    """Monotonic time at which the image was complete on this PC."""
    frame_id: int
    """Counts up by one with each exposure; a repeated number is a repeated image."""
    exposure: ExposureRecord | None = None
    """How it was exposed, as far as the driver knows."""


class Camera(AdjustableExposure, Device):
    """Called by steps and calibration procedures, from the daemon's event loop only.

    Connecting takes no image. Whoever needs a sharp image waits for standstill before ``grab``;
    the camera knows nothing of the robot that may carry it.

    Methods may raise ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation`` or ``DeviceFault``.
    After any of them the next call starts on a clean connection or raises ``LinkLost``: an image
    that was exposed for a call that failed is never returned by a later one.
    """

    @abstractmethod
    async def serial_number(self) -> str:
        """Serial number of the camera, for the record and the calibration gate."""

    @abstractmethod
    async def grab(self) -> CameraImage:
        """Expose now and return an image that was exposed after this call."""
