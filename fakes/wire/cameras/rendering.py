"""Exposures by the process that renders, as all fake cameras take them."""

import asyncio
from concurrent.futures import BrokenExecutor, Executor

from fakes.render.options import RenderOptions
from fakes.render.worker import Frame, render_frame
from fakes.world.scene import CameraScene


class ExposureError(Exception):
    """The cameras could not expose: for the client, a fault of the camera."""


async def rendered(
    pool: Executor, scene: CameraScene, options: RenderOptions, faults: frozenset[str]
) -> Frame:
    """A scene as ``pool`` renders it; raises ``ExposureError`` when its process has died."""
    loop = asyncio.get_running_loop()
    try:
        return await loop.run_in_executor(pool, render_frame, scene, options, faults)
    except BrokenExecutor as error:
        raise ExposureError("the process that renders has died") from error
