"""The cameras of a scenario behind the fake GenTL producer."""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path
from typing import Any

from fakes.device import Device
from fakes.gentl.cameras import FakeCameras, Fault
from fakes.gentl.exposures import Asked, Exposed, ExposureServer
from fakes.gentl.shown import shown
from fakes.render.options import RenderOptions
from fakes.render.worker import Frame
from fakes.scenario_file.scenario import Scenario
from fakes.wire.cameras.gentl_camera import GentlCamera, Take
from fakes.wire.cameras.gentl_faults import GentlFaults
from fakes.wire.cameras.rendering import rendered
from fakes.world.world import World


class GentlRack:
    """All of them in one file, answered at one place."""

    def __init__(
        self, world: World[Any], pool: Executor, options: RenderOptions, file: Path
    ) -> None:
        """``pool`` renders; ``file`` is that of the cameras, written anew."""
        self._scenario: Scenario = world.scenario
        self._world, self._pool, self._options = world, pool, options
        self._server = ExposureServer(self._expose)
        self._shown = shown(world.scenario)
        self._cameras = {name: self._made(name) for name in self._shown}
        every = [(name, n) for name, lenses in self._shown.items() for n in range(len(lenses))]
        self._lenses = [(self._cameras[name], lens) for name, lens in every]
        """Device and lens of each camera, in the order of the cameras in the file."""
        lenses = [self._shown[name][lens] for name, lens in every]
        self._file = FakeCameras(file, lenses, self._server.address)

    def devices(self) -> Iterator[Device]:
        """One for each head and camera; none of them has a port."""
        for name, camera in self._cameras.items():
            yield Device(name, 0, camera.faults, self._start, self._stop)

    def _made(self, name: str) -> GentlCamera:
        lenses = self._shown[name]

        def at_producer(fault: Fault, amount: int) -> None:
            for lens in lenses:
                self._file.inject(lens.serial, fault, amount)

        usual_us = self._scenario.optics_of(name).exposure_us
        return GentlCamera(
            self._take(name), GentlFaults(at_producer), lenses=len(lenses), exposure_us=usual_us
        )

    def _take(self, name: str) -> Take:
        async def take(faults: frozenset[str], brightness: float) -> Frame:
            scene = self._world.camera_scene(name)
            gain = scene.exposure.gain * brightness
            scene = replace(scene, exposure=replace(scene.exposure, gain=gain))
            return await rendered(self._pool, scene, self._options, faults)

        return take

    async def _expose(self, asked: Asked) -> Exposed | None:
        camera, lens = self._lenses[asked.camera]
        return await camera.expose(lens, asked)

    async def _start(self) -> int:
        await self._server.start()
        return 0

    async def _stop(self) -> None:
        """The first device that stops ends all of them: they are answered at one place."""
        await self._server.stop()
        for camera in self._cameras.values():
            camera.stop()
