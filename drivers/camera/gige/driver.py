"""A single camera and a stereo head over GenTL."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from cellctl.errors.camera import CameraFeatureRefused, ImagesDamaged
from cellctl.errors.link import LinkError, LinkLost, ProtocolViolation, ReplyTimeout
from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from cellctl.interfaces.device import Device
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair
from drivers.camera.gige.config import GigeCameraConfig, GigeHeadConfig
from drivers.camera.gige.connection import Block, LibraryProcess
from drivers.camera.gige.pixels import Pixels, bits_of, decoded, grey
from drivers.camera.gige.protocol import (
    Answer,
    CameraSetup,
    Grabbed,
    GrabRequest,
    Opened,
    OpenedCamera,
    OpenRequest,
    Request,
    SentImage,
    SetExposureRequest,
)
from drivers.camera.gige.running_mean import RunningMean
from drivers.camera.gige.simultaneity import Simultaneity

_PATIENCE_S = 2.0
"""What the process may take beyond the time-outs of its own before it counts as hung."""
T = TypeVar("T")
_log = logging.getLogger(__name__)


class GigeDevice(Device):
    """What camera and head share: one process of the maker's library for all of its cameras."""

    def __init__(self, name: str, cameras: tuple[CameraSetup, ...]) -> None:
        self.name = name
        self._settings = cameras[0].settings
        self._cameras = cameras
        self._library = LibraryProcess(name)
        self._turn = asyncio.Lock()
        self._burst = asyncio.Lock()
        """Held from the first image of a burst to its last one, and while the exposure changes.

        A cancelled burst gives it back at once; a request that was sent keeps its turn."""
        self._exposure_s: float | None = None
        """What was set since the connection was asked for, in place of the settings'."""
        self._opened: tuple[OpenedCamera, ...] = ()
        self._frame = 0

    async def connect(self) -> None:
        """Load the producers, open and set up the cameras; exposes nothing. Idempotent."""
        await self._in_turn(self._connected)

    async def disconnect(self) -> None:
        """Let the cameras go and end the process. Idempotent."""
        await self._in_turn(self._ended)

    async def serial_number(self) -> str:
        """Serial numbers of the cameras, left and right with a plus between them."""
        if not self._opened:
            raise LinkLost(f"{self.name}: not connected")
        return "+".join(camera.serial_number for camera in self._opened)

    async def set_exposure(self, exposure_s: float) -> float:
        """Set the exposure of all cameras; it is kept when a lost camera is opened anew, until
        ``disconnect``. Waits for a burst that is being taken."""

        async def change() -> float:
            answer, _ = await self._asked(SetExposureRequest(exposure_s), _PATIENCE_S)
            if not isinstance(answer, Opened):
                raise ProtocolViolation(f"{self.name}: {type(answer).__name__} for an exposure")
            self._opened = answer.cameras
            self._exposure_s = answer.cameras[0].exposure_s or exposure_s
            return self._exposure_s

        # The images of a burst are averaged, and its record names one exposure for all of them.
        async with self._burst:
            return await self._in_turn(change)

    async def _exposed(self) -> tuple[Grabbed, list[Block]]:
        async def grab() -> tuple[Grabbed, list[Block]]:
            settings = self._settings
            patience_s = settings.tries * settings.image_timeout_s * len(self._cameras)
            answer, blocks = await self._asked(GrabRequest(), patience_s + _PATIENCE_S)
            if not isinstance(answer, Grabbed) or len(blocks) != len(self._cameras):
                raise ProtocolViolation(f"{self.name}: {type(answer).__name__} for images")
            if answer.taken_again:
                _log.warning("%s: %d damaged or old images", self.name, answer.taken_again)
            return answer, blocks

        return await self._in_turn(grab)

    async def _asked(self, request: Request, timeout_s: float) -> tuple[Answer, list[Block]]:
        """Ask open cameras; those that were lost are opened anew first."""
        if not self._opened:
            raise LinkLost(f"{self.name}: not connected")
        if not self._library.running:
            await self._connected()
        try:
            return await self._ask(request, timeout_s)
        except (ReplyTimeout, ImagesDamaged, CameraFeatureRefused):
            raise  # the cameras are there
        except LinkError:
            # A maker's library seldom finds a camera again that it has lost: its handle stays
            # dead when the cable is back. The next request opens the camera anew.
            await asyncio.to_thread(self._library.end)
            raise

    def _forget(self) -> None:
        """Drop what earlier images have told: cameras that are opened anew may have been off."""

    def _next_frame(self) -> int:
        self._frame += 1
        return self._frame

    def _decoded(self, image: SentImage, data: Block) -> tuple[Pixels, PixelFormat]:
        try:
            return decoded(data, image.pixel_format, image.width, image.height)
        except ValueError as error:
            raise ImagesDamaged(f"{self.name}: {error}") from error

    def _record(self, number: int, image: SentImage, bits: int, taken_again: int) -> ExposureRecord:
        camera = self._opened[number]
        return ExposureRecord(
            serial_number=camera.serial_number,
            pixel_format=image.pixel_format,
            bits=bits,
            exposure_s=camera.exposure_s if image.exposure_s is None else image.exposure_s,
            gain_db=camera.gain_db if image.gain_db is None else image.gain_db,
            averaged=self._settings.burst,
            taken_again=taken_again,
            device_time_ns=image.device_time_ns or None,
        )

    async def _connected(self) -> None:
        if self._library.running:
            return
        self._forget()
        await asyncio.to_thread(self._library.start)
        try:
            answer, _ = await self._ask(
                OpenRequest(self._setups()), self._settings.connect_timeout_s
            )
        except BaseException:
            await asyncio.to_thread(self._library.end)
            raise
        if not isinstance(answer, Opened):
            raise ProtocolViolation(f"{self.name}: {type(answer).__name__} for open cameras")
        self._opened = answer.cameras
        for camera in answer.cameras:
            await self._require_readable(camera)

    def _setups(self) -> tuple[CameraSetup, ...]:
        if self._exposure_s is None:
            return self._cameras
        return tuple(
            replace(one, settings=replace(one.settings, exposure_s=self._exposure_s))
            for one in self._cameras
        )

    async def _require_readable(self, camera: OpenedCamera) -> None:
        """Raise ``CameraFeatureRefused`` for images that this driver could not read."""
        try:
            if camera.pixel_format:
                bits_of(camera.pixel_format)
        except ValueError as error:
            await self._ended()
            text = f"{self.name}: {camera.serial_number}: {error}; set pixel_format"
            raise CameraFeatureRefused(text) from error

    async def _ended(self) -> None:
        self._opened = ()
        self._exposure_s = None
        await asyncio.to_thread(self._library.end)

    async def _ask(self, request: Request, timeout_s: float) -> tuple[Answer, list[Block]]:
        return await asyncio.to_thread(self._library.ask, request, timeout_s)

    async def _in_turn(self, work: Callable[[], Awaitable[T]]) -> T:
        """One after the other, and to its end even when the caller is cancelled.

        A request that nobody waits for any more has its answer read and dropped all the same, so
        that the next caller does not get it for his own.
        """

        async def turn() -> T:
            async with self._turn:
                return await work()

        return await asyncio.shield(asyncio.ensure_future(turn()))


class GigeCamera(GigeDevice, Camera):
    """One camera."""

    Config = GigeCameraConfig

    def __init__(self, name: str, config: GigeCameraConfig) -> None:
        super().__init__(name, (config.setup_of(config.camera),))
        self._grey = config.grey

    async def grab(self) -> CameraImage:
        """Expose now; damaged images are taken again as often as the settings allow."""
        async with self._burst:
            mean: RunningMean[Any] = RunningMean()
            taken_again = 0
            for _ in range(self._settings.burst):
                grabbed, (data,) = await self._exposed()
                (image,) = grabbed.images
                taken_again += grabbed.taken_again
                pixels, pixel_format = self._decoded(image, data)
                bits = bits_of(image.pixel_format)
                if self._grey and pixel_format in (PixelFormat.RGB8, PixelFormat.RGB16):
                    pixels = grey(pixels, pixel_format, bits)
                    pixel_format, bits = PixelFormat.MONO8, 8
                mean.add(pixels)
            record = self._record(0, image, bits, taken_again)
            return CameraImage(
                mean.pixels(), pixel_format, image.time_s, self._next_frame(), record
            )


class GigeHead(GigeDevice, StereoCamera):
    """Two cameras, triggered one right after the other."""

    Config = GigeHeadConfig

    def __init__(self, name: str, config: GigeHeadConfig) -> None:
        left, right = config.of_left(), config.of_right()
        super().__init__(name, (left.setup_of(config.left), right.setup_of(config.right)))
        self._simultaneity = Simultaneity(name, config)

    def _forget(self) -> None:
        self._simultaneity.forget()  # clocks begin anew with the power

    async def grab(self) -> StereoPair:
        """Expose both cameras now."""
        async with self._burst:
            left: RunningMean[np.uint8] = RunningMean()
            right: RunningMean[np.uint8] = RunningMean()
            taken_again = 0
            for _ in range(self._settings.burst):
                grabbed, blocks = await self._exposed()
                images = grabbed.images
                taken_again += grabbed.taken_again
                self._simultaneity.require(images[0], images[1])
                for mean, image, block in zip((left, right), images, blocks, strict=True):
                    pixels, kind = self._decoded(image, block)
                    mean.add(grey(pixels, kind, bits_of(image.pixel_format)))
            records = tuple(
                self._record(number, image, 8, taken_again) for number, image in enumerate(images)
            )
            time_s = images[0].time_s
            return StereoPair(left.pixels(), right.pixels(), time_s, self._next_frame(), records)
