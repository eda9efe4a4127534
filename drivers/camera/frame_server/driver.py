"""A stereo head behind a frame server that speaks CFS/1 (docs/protocols/frame-server.md)."""

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost, ProtocolViolation
from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair
from drivers.camera.frame_server import protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.connection import FrameServerConnection
from drivers.camera.frame_server.protocol import Command, Header


class FrameServerHead(StereoCamera):
    """Between ``connect`` and ``disconnect`` a lost connection is made again by the next request;
    the request that lost it fails.
    """

    Config = FrameServerConfig

    def __init__(self, name: str, config: FrameServerConfig) -> None:
        self.name = name
        self._connection = FrameServerConnection(name, config)
        self._wanted = False
        self._last: Header | None = None

    async def connect(self) -> None:
        """Connect and see that a head answers."""
        await self._connection.link.open()
        self._wanted = True
        try:
            await self.serial_number()
        except BaseException:
            await self.disconnect()
            raise

    async def disconnect(self) -> None:
        """Drop the connection."""
        self._wanted = False
        await self._connection.link.close()

    async def serial_number(self) -> str:
        """Serial number of the head."""
        await self._ready()
        _, payload = await self._connection.exchange(Command.IDENTIFY)
        _, serial, _ = protocol.parse_identity(payload)
        return serial

    async def grab(self) -> StereoPair:
        """Expose now. A frame number or time stamp that does not move on is a violation: the
        server would have sent an old pair."""
        await self._ready()
        header, payload = await self._connection.exchange(Command.GRAB)
        time_s = now_s()
        last, self._last = self._last, header
        if last is not None and (
            header.frame_id == last.frame_id or header.exposure_time_us <= last.exposure_time_us
        ):
            await self._connection.link.close()
            raise ProtocolViolation(f"{self.name}: the server sent pair {header.frame_id} again")
        left, right = protocol.split_images(header, payload)
        return StereoPair(left, right, time_s, header.frame_id)

    async def _ready(self) -> None:
        if not self._wanted:
            raise LinkLost(f"{self.name} is not connected")
        if not self._connection.link.connected:
            self._last = None
            await self._connection.link.open()
