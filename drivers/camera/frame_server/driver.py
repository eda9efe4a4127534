"""A stereo head and a single camera behind a server that speaks CFS/1
(docs/protocols/frame-server.md).
"""

from cellctl.interfaces.camera import Camera, CameraImage
from cellctl.interfaces.device import Device
from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair
from drivers.camera.frame_server import protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.connection import FrameServerConnection
from drivers.camera.frame_server.protocol import ServerCommand


class FrameServerDevice(Device):
    """What head and camera share; how the link behaves is said by its connection."""

    Config = FrameServerConfig

    def __init__(self, name: str, config: FrameServerConfig) -> None:
        self.name = name
        self._connection = FrameServerConnection(name, config)

    async def connect(self) -> None:
        """Connect and see that a device answers."""
        await self._connection.connect()

    async def disconnect(self) -> None:
        """Drop the connection."""
        await self._connection.disconnect()

    async def serial_number(self) -> str:
        """Serial number of the head or camera."""
        return await self._connection.serial_number()


class FrameServerHead(FrameServerDevice, StereoCamera):
    """Two cameras that expose together."""

    async def grab(self) -> StereoPair:
        """Expose both cameras now."""
        # One request for both: the server triggers them together, two requests would be two
        # moments.
        exposure = await self._connection.expose(ServerCommand.GRAB_PAIR)
        left, right = protocol.split_images(exposure.header, exposure.payload)
        header = exposure.header
        one = protocol.exposure_record(header)
        return StereoPair(left, right, exposure.time_s, header.frame_id, (one, one))


class FrameServerCamera(FrameServerDevice, Camera):
    """One camera, grey or colour, as its server sends it."""

    async def grab(self) -> CameraImage:
        """Expose now. The server of a stereo head refuses this with ``DeviceFault``."""
        exposure = await self._connection.expose(ServerCommand.GRAB_IMAGE)
        pixels, pixel_format = protocol.to_pixels(exposure.header, exposure.payload)
        header = exposure.header
        record = protocol.exposure_record(header)
        return CameraImage(pixels, pixel_format, exposure.time_s, header.frame_id, record)
