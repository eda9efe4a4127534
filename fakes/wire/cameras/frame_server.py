"""The fake frame server of a stereo head: CFS/1 of docs/protocols/frame-server.md.

The scene is taken when the request arrives; rendering runs in a pool of worker processes, so the
event loop of the fake cell never waits for it.
"""

from collections.abc import Callable
from concurrent.futures import Executor

from fakes.render.options import RenderOptions
from fakes.wire.cameras.cfs_server import CfsServer, Reply
from fakes.wire.cameras.rendering import rendered
from fakes.world.scene import CameraScene


class FrameServer(CfsServer):
    """Serves one head: pairs of images, left then right."""

    grab_command = 2

    def __init__(
        self,
        host: str,
        port: int,
        scene: Callable[[], CameraScene],
        pool: Executor,
        *,
        options: RenderOptions | None = None,
        identity: str = "fake-head;FH-0001;1.0",
        exposure_us: int = 8000,
    ) -> None:
        """``scene`` is called in the event loop at every grab; ``pool`` runs ``render_frame``."""
        super().__init__(host, port, identity)
        self._scene = scene
        self._pool = pool
        self._options = options or RenderOptions()
        self._exposure_us = exposure_us
        self._frame_id = 0

    async def expose(self, faults: frozenset[str]) -> Reply:
        """The pair of images of the scene as it is now."""
        scene = self._scene()
        self._frame_id += 1
        frame_id = self._frame_id
        frame = await rendered(self._pool, scene, self._options, faults)
        return Reply(
            request_id=0,
            frame_id=frame_id,
            time_us=round(scene.time_s * 1e6),
            exposure_us=self._exposure_us,
            width=frame.width,
            height=frame.height,
            images=2,
            payload=frame.payload,
            payload_crc=frame.crc,
        )
