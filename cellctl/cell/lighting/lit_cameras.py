"""Cameras and heads with a lamp at a digital output that is on while they expose."""

from collections.abc import Mapping

from cellctl.cell.lighting.light import Light
from cellctl.config.devices import CameraConfig, LightConfig
from cellctl.errors import CellError
from cellctl.errors.digital_io import SignalUnknown
from cellctl.interfaces import Camera, CameraImage, DigitalIo, StereoCamera, StereoPair
from cellctl.interfaces.device import Device


class LitDevice(Device):
    """Passes each call on; raises what the device behind it raises, and faults of its lamp."""

    def __init__(self, device: Camera | StereoCamera, light: Light, settle_s: float) -> None:
        self.name = device.name
        self._device = device
        self._light, self._settle_s = light, settle_s

    async def connect(self) -> None:
        """As the device behind it; the digital I/O is a device of its own."""
        await self._device.connect()

    async def disconnect(self) -> None:
        """As the device behind it."""
        await self._device.disconnect()

    def incidents(self) -> tuple[CellError, ...]:
        """Those of the device behind it."""
        return self._device.incidents()

    async def serial_number(self) -> str:
        """Serial number of the device behind it."""
        return await self._device.serial_number()

    async def set_exposure(self, exposure_s: float) -> float:
        """As the device behind it."""
        return await self._device.set_exposure(exposure_s)


class LitCamera(LitDevice, Camera):
    """A single camera behind its lamp."""

    def __init__(self, camera: Camera, light: Light, settle_s: float) -> None:
        super().__init__(camera, light, settle_s)
        self._camera = camera

    async def grab(self) -> CameraImage:
        """As the camera behind it, in the light."""
        async with self._light.on(self._settle_s):
            return await self._camera.grab()


class LitHead(LitDevice, StereoCamera):
    """A stereo head behind its lamp."""

    def __init__(self, head: StereoCamera, light: Light, settle_s: float) -> None:
        super().__init__(head, light, settle_s)
        self._head = head

    async def grab(self) -> StereoPair:
        """As the head behind it, in the light."""
        async with self._light.on(self._settle_s):
            return await self._head.grab()


class Lights:
    """The lamps of a cell: cameras that name the same output share one lamp."""

    def __init__(self, ios: Mapping[str, DigitalIo]) -> None:
        self._ios = ios
        self._lights: dict[tuple[str, str], Light] = {}

    def cameras(
        self, built: Mapping[str, Camera], sections: Mapping[str, CameraConfig]
    ) -> Mapping[str, Camera]:
        """The cameras, each behind the lamp of its section if that names one.

        Raises ``SignalUnknown`` for an output that the digital I/O does not have.
        """
        return {
            name: camera
            if (light := sections[name].light) is None
            else LitCamera(camera, self._of(light), light.settle_s)
            for name, camera in built.items()
        }

    def heads(
        self, built: Mapping[str, StereoCamera], sections: Mapping[str, CameraConfig]
    ) -> Mapping[str, StereoCamera]:
        """The same for stereo heads."""
        return {
            name: head
            if (light := sections[name].light) is None
            else LitHead(head, self._of(light), light.settle_s)
            for name, head in built.items()
        }

    def _of(self, light: LightConfig) -> Light:
        io = self._ios[light.device]
        if light.output not in io.output_names:
            there = ", ".join(io.output_names) or "none"
            raise SignalUnknown(f"{light.output}; outputs of {light.device}: {there}")
        place = light.device, light.output
        return self._lights.setdefault(place, Light(io, light.output))
