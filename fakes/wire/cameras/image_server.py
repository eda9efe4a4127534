"""The fake frame server of a single camera: CFS/1 of docs/protocols/frame-server.md."""

import zlib
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from fakes.wire.cameras.cfs_server import MONO8, CfsServer, Reply


@dataclass(frozen=True, slots=True)
class Picture:
    """One image, ready for the wire."""

    width: int
    height: int
    payload: bytes
    """Pixels as the protocol lays them out, rows from the top."""
    time_s: float
    """When it was exposed, by the clock of the world."""
    pixel_format: int = MONO8
    """The number on the wire."""


Take = Callable[[frozenset[str]], Awaitable[Picture]]
"""Takes a picture of the scene as it is now, with the named faults of scene and picture."""


class ImageServer(CfsServer):
    """Serves one camera, one image a grab."""

    grab_command = 3

    def __init__(
        self,
        host: str,
        port: int,
        take: Take,
        *,
        identity: str = "fake-camera;FC-0001;1.0",
        exposure_us: int = 8000,
    ) -> None:
        super().__init__(host, port, identity)
        self._take = take
        self._exposure_us = exposure_us
        self._frame_id = 0

    async def expose(self, faults: frozenset[str]) -> Reply:
        """The image that ``take`` makes."""
        self._frame_id += 1
        frame_id = self._frame_id
        picture = await self._take(faults)
        return Reply(
            request_id=0,
            frame_id=frame_id,
            time_us=round(picture.time_s * 1e6),
            exposure_us=self._exposure_us,
            width=picture.width,
            height=picture.height,
            images=1,
            pixel_format=picture.pixel_format,
            payload=picture.payload,
            payload_crc=zlib.crc32(picture.payload),
        )
