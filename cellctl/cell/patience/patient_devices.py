"""Cameras, heads, trackers, grippers and digital I/O whose drivers may hang in a call."""

from collections.abc import Coroutine, Mapping
from typing import Any, Generic, TypeVar

from cellctl.cell.patience.calls import PATIENCE_S, answer_within
from cellctl.cell.patience.repeated_images import RepeatedImages
from cellctl.errors import CellError
from cellctl.interfaces import (
    Camera,
    CameraImage,
    DigitalIo,
    Gripper,
    GripperState,
    StereoCamera,
    StereoPair,
    TargetTracker,
)
from cellctl.interfaces.device import Device
from cellctl.interfaces.digital_io import DigitalIoState
from cellctl.interfaces.target_tracker import Target

T = TypeVar("T")
D = TypeVar("D", bound=Device)
Imager = TypeVar("Imager", bound=Camera | StereoCamera)


class PatientDevice(Device, Generic[D]):
    """Passes each call on; ``ReplyTimeout`` from one that does not come back in time."""

    def __init__(self, device: D, patience_s: float = PATIENCE_S) -> None:
        self.name = device.name
        self._device = device
        self._patience_s = patience_s

    async def connect(self) -> None:
        """As the device behind it."""
        await self._answer(self._device.connect())

    async def disconnect(self) -> None:
        """As the device behind it."""
        await self._answer(self._device.disconnect())

    def incidents(self) -> tuple[CellError, ...]:
        """Those of the device behind it."""
        return self._device.incidents()

    async def _answer(self, call: Coroutine[Any, Any, T]) -> T:
        return await answer_within(call, self.name, self._patience_s)


class PatientImager(PatientDevice[Imager], Generic[Imager]):
    """What camera and head share."""

    def __init__(self, device: Imager, patience_s: float = PATIENCE_S) -> None:
        super().__init__(device, patience_s)
        self._repeated = RepeatedImages(device.name)

    async def serial_number(self) -> str:
        """Serial number of the device behind it."""
        return await self._answer(self._device.serial_number())

    async def set_exposure(self, exposure_s: float) -> float:
        """As the device behind it."""
        return await self._answer(self._device.set_exposure(exposure_s))


class PatientCamera(PatientImager[Camera], Camera):
    """A single camera."""

    async def grab(self) -> CameraImage:
        """As the camera behind it; ``ImageRepeated`` for an image that is the last one."""
        image = await self._answer(self._device.grab())
        self._repeated.require_new({"image": image.pixels})
        return image


class PatientHead(PatientImager[StereoCamera], StereoCamera):
    """A stereo head."""

    async def grab(self) -> StereoPair:
        """As the head behind it; ``ImageRepeated`` for an image that is the last one."""
        pair = await self._answer(self._device.grab())
        self._repeated.require_new({"left image": pair.left, "right image": pair.right})
        return pair


class PatientTracker(PatientDevice[TargetTracker], TargetTracker):
    """A large-field head."""

    async def serial_number(self) -> str:
        """Serial number of the tracker behind it."""
        return await self._answer(self._device.serial_number())

    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        """As the tracker behind it."""
        return await self._answer(self._device.measure(frames))


class PatientGripper(PatientDevice[Gripper], Gripper):
    """A gripper; a call that is left does not stop its jaws."""

    async def state(self) -> GripperState:
        """State of the gripper behind it."""
        return await self._answer(self._device.state())

    async def open(self) -> GripperState:
        """As the gripper behind it."""
        return await self._answer(self._device.open())

    async def close(self) -> GripperState:
        """As the gripper behind it."""
        return await self._answer(self._device.close())

    async def confirm_part(self) -> GripperState:
        """As the gripper behind it."""
        return await self._answer(self._device.confirm_part())


class PatientIo(PatientDevice[DigitalIo], DigitalIo):
    """Digital inputs and outputs."""

    def __init__(self, io: DigitalIo, patience_s: float = PATIENCE_S) -> None:
        super().__init__(io, patience_s)
        self.input_names, self.output_names = io.input_names, io.output_names

    async def read(self) -> DigitalIoState:
        """As the device behind it."""
        return await self._answer(self._device.read())

    async def write(self, outputs: Mapping[str, bool]) -> None:
        """As the device behind it."""
        await self._answer(self._device.write(outputs))
