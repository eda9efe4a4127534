"""The cameras of a fake cell, behind frame servers or behind the fake GenTL producer."""

from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from fakes.device import Device
from fakes.render.look import options_of
from fakes.render.options import RenderOptions
from fakes.render.worker import make_pool
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import SingleCamera, StereoCamera
from fakes.wire.cameras.cfs_server import MONO8, RGB8, CfsServer
from fakes.wire.cameras.frame_server import FrameServer
from fakes.wire.cameras.gentl_rack import GentlRack
from fakes.wire.cameras.image_server import ImageServer, Picture
from fakes.wire.cameras.rendering import rendered
from fakes.world.world import World

HOST = "127.0.0.1"


class CameraRack:
    """Every stereo head and single camera of a scenario, and the process that renders for them."""

    def __init__(
        self, world: World[Any], ports: Mapping[str, int], gentl: Path | None = None
    ) -> None:
        """Arguments are those of ``DeviceRack``."""
        self._scenario: Scenario = world.scenario
        self._world, self._ports, self._gentl = world, ports, gentl
        self._renderers: ProcessPoolExecutor | None = None

    def devices(self) -> Iterator[Device]:
        """One for each head and camera; the first one starts the renderer."""
        if not self._scenario.all_cameras():
            return
        if self._gentl is not None:
            rack = GentlRack(self._world, self._pool(), self._look(), self._gentl)
            yield from rack.devices()
            return
        for name, head in self._scenario.stereo_cameras.items():
            yield self._stereo_camera(name, head)
        for name, camera in self._scenario.cameras.items():
            yield self._camera(name, camera)

    def shut_down(self) -> None:
        """End the renderer, once the cameras have stopped."""
        if self._renderers is not None:
            self._renderers.shutdown(cancel_futures=True)

    def _stereo_camera(self, name: str, camera: StereoCamera) -> Device:
        port = self._ports.get(name, camera.port)
        server = FrameServer(
            HOST,
            port,
            partial(self._world.camera_scene, name),
            self._pool(),
            options=self._look(),
            identity=f"fake-head;{camera.serial};1.0",
            exposure_us=self._scenario.optics_of(name).exposure_us,
        )
        return _frame_device(name, port, server)

    def _camera(self, name: str, camera: SingleCamera) -> Device:
        pool, options = self._pool(), self._look()

        async def take(faults: frozenset[str]) -> Picture:
            scene = self._world.camera_scene(name)
            frame = await rendered(pool, scene, options, faults)
            pixel_format = RGB8 if camera.colour else MONO8
            return Picture(frame.width, frame.height, frame.payload, scene.time_s, pixel_format)

        port = self._ports.get(name, camera.port)
        server = ImageServer(
            HOST,
            port,
            take,
            identity=f"fake-camera;{camera.serial};1.0",
            exposure_us=self._scenario.optics_of(name).exposure_us,
        )
        return _frame_device(name, port, server)

    def _look(self) -> RenderOptions:
        rendering = self._scenario.rendering
        assert rendering is not None  # the scenario's model demands it where there is a camera
        return options_of(
            rendering,
            glare=self._scenario.size_of("glare"),
            tilt_shading=self._scenario.size_of("tilt_shading"),
        )

    def _pool(self) -> ProcessPoolExecutor:
        """One renderer for all cameras; a cell without cameras does without."""
        if self._renderers is None:
            self._renderers = make_pool()
        return self._renderers


def _frame_device(name: str, port: int, server: CfsServer) -> Device:
    async def start() -> int:
        await server.start()
        return server.port

    return Device(name, port, server.faults, start, server.stop)
