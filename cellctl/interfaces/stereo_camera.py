"""A stereo head: two cameras that expose together."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.device import Device
from cellctl.interfaces.exposure import AdjustableExposure, ExposureRecord

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class StereoPair:
    """Two images of one exposure."""

    left: Image
    """Shape (height, width), 8 bit grey, pixel centres at integers."""
    right: Image
    time_s: float
    """Monotonic time of receipt of the request's exposure."""
    frame_id: int
    """Counts up by one a pair; a repeated number is a repeated image."""
    exposures: tuple[ExposureRecord, ...] = ()
    """How left and right were exposed, in this order; empty where the driver does not know."""


class StereoCamera(AdjustableExposure, Device):
    """Called by steps and calibration procedures while the head stands still.

    Methods may raise ``ConnectTimeout``, ``LinkLost``, ``ReplyTimeout``, ``ProtocolViolation``.
    """

    @abstractmethod
    async def serial_number(self) -> str:
        """Serial number of the head, for the record and the calibration gate."""

    @abstractmethod
    async def grab(self) -> StereoPair:
        """Expose now and return a pair that was exposed after this call."""
