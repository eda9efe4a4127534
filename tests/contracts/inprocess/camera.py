"""A single camera in memory."""

from cellctl.clock import now_s
from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from tests.contracts.inprocess.exposure import InProcessExposure
from tests.wire.cameras.camera_bench import pixels


class InProcessCamera(InProcessExposure, Camera):
    """A ramp that shifts with each exposure."""

    def __init__(self, name: str, pixel_format: PixelFormat) -> None:
        super().__init__(name)
        self._pixel_format = pixel_format

    async def grab(self) -> CameraImage:
        number = await self._expose()
        array = pixels(self._pixel_format, number)
        return CameraImage(array, self._pixel_format, now_s(), number)
