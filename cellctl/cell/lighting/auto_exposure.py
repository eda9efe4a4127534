"""Sets the exposure of a camera by the surface round the holes, in bounded tries and time."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import asdict, dataclass

from cellctl import log
from cellctl.cell.devices import Cell
from cellctl.config.devices import AutoExposureConfig, CameraConfig
from cellctl.errors.camera import ExposureNotReached
from cellctl.interfaces import Camera, StereoCamera
from cellctl.interfaces.camera import CameraImage
from cellctl.interfaces.exposure import AdjustableExposure
from cellctl.interfaces.stereo_camera import Image
from cellctl.records.run_recorder import RunRecorder
from cellctl.vision.camera.depth import grey_of
from cellctl.vision.camera.exposure_search import (
    Brightness,
    ExposureAim,
    ExposureSearch,
    light_round_holes,
    of_all,
)

_log = log.get(__name__)
AUTO_EXPOSURE = "images.auto_exposure"
"""Key of the document that holds what was found for each camera of a run."""
_FIRST_S = 0.005
"""First exposure to try where the camera does not say how long it exposes, or sets it by itself."""


@dataclass(frozen=True, slots=True)
class Looked:
    """One exposure of a camera or head."""

    exposure_s: float | None
    """Exposure time as the camera states it."""
    light: Brightness


@dataclass(frozen=True, slots=True)
class FoundExposure:
    """What an automatic exposure has ended with."""

    exposure_s: float
    grey: float
    """Round the holes, in grey values of 8 bit; of a head, that of the brighter view."""
    saturated_share: float
    """Share of saturated pixels round the holes."""
    holes: int
    exposures: int
    """How many exposures were taken to find it."""


async def found_exposure(
    device: AdjustableExposure, wanted: AutoExposureConfig, look: Callable[[], Awaitable[Looked]]
) -> FoundExposure:
    """Set the exposure of a connected device; ``look`` takes one with it.

    Raises ``ExposureNotReached``, also after ``tries`` or ``within_s``, with the exposure left as
    it was last; ``ExposureNotAdjustable``, and what the driver raises.
    """
    try:
        async with asyncio.timeout(wanted.within_s):
            return await _search(device, wanted, look)
    except TimeoutError as error:
        raise ExposureNotReached(f"{device.name}: not within {wanted.within_s:g} s") from error


async def _search(
    device: AdjustableExposure, wanted: AutoExposureConfig, look: Callable[[], Awaitable[Looked]]
) -> FoundExposure:
    least_ms, greatest_ms = wanted.exposure_ms
    aim = ExposureAim(wanted.target_grey, least_ms * 1e-3, greatest_ms * 1e-3)
    search = ExposureSearch(aim)
    next_s = aim.within((await look()).exposure_s or _FIRST_S)
    for tried in range(1, wanted.tries + 1):
        exposure_s = await device.set_exposure(next_s)
        light = (await look()).light
        verdict = search.judge(exposure_s, light)
        if verdict.shortfall:
            raise ExposureNotReached(f"{device.name}: {verdict.shortfall}")
        if verdict.next_s is None:
            exposures = tried + 1  # with the first look, which only asks what the camera has set
            return FoundExposure(
                exposure_s, light.grey, light.saturated_share, light.holes, exposures
            )
        next_s = verdict.next_s
    raise ExposureNotReached(f"{device.name}: not in {wanted.tries} exposures")


class RunExposures:
    """The cameras of one run: each exposure is found before its first measurement, then it stays.

    A camera whose section has no ``auto_exposure`` is left as it is.
    """

    def __init__(
        self, cell: Cell, recorder: RunRecorder, grey: Callable[[CameraImage], Image] = grey_of
    ) -> None:
        """``grey`` gives the plane of a single camera's image that is measured."""
        sections = dict[str, CameraConfig](cell.config.cameras) | cell.config.stereo_cameras
        self._wanted = {name: section.auto_exposure for name, section in sections.items()}
        self._workers = cell.workers
        self._recorder = recorder
        self._grey = grey
        self._found: set[str] = set()

    async def find(self, device: Camera | StereoCamera) -> None:
        """Before a measurement, while nothing moves and the holes are in view.

        Raises like ``found_exposure``.
        """
        wanted = self._wanted.get(device.name)
        if wanted is None or device.name in self._found:
            return

        async def look() -> Looked:
            return await self._looked(device, wanted.hole_px)

        found = await found_exposure(device, wanted, look)
        self._found.add(device.name)
        _log.info("exposure found", camera=device.name, **asdict(found))
        await self._recorder.document(AUTO_EXPOSURE, {device.name: asdict(found)})

    async def _looked(self, device: Camera | StereoCamera, hole_px: tuple[float, float]) -> Looked:
        if isinstance(device, StereoCamera):
            pair = await device.grab()
            images = [pair.left, pair.right]
            stated = pair.exposures[0] if pair.exposures else None
        else:
            image = await device.grab()
            images, stated = [self._grey(image)], image.exposure
        light = [await self._workers.run(light_round_holes, one, hole_px) for one in images]
        return Looked(None if stated is None else stated.exposure_s, of_all(light))
