"""`cellctl focus --auto`: exposes until the surface round the holes has the wanted grey."""

import asyncio

from cellctl.cli.cameras.opening import Chosen, Exposed
from cellctl.errors.camera import ExposureNotReached
from cellctl.vision.camera.exposure_search import (
    Brightness,
    ExposureAim,
    ExposureSearch,
    light_round_holes,
    of_all,
)

MOST_EXPOSURES = 16
WITHIN_S = 60.0
_FIRST_S = 0.005
"""Where the camera does not say how long it exposes, or sets it by itself."""


async def exposed_for_holes(
    device: Chosen, aim: ExposureAim, radii_px: tuple[float, float]
) -> float:
    """Set the exposure of an open device, and return it in seconds.

    Raises ``ExposureNotReached``, also after ``MOST_EXPOSURES`` or ``WITHIN_S``, with the exposure
    left as it was last; ``ExposureNotAdjustable``, and what the driver raises.
    """
    try:
        async with asyncio.timeout(WITHIN_S):
            return await _search(device, aim, radii_px)
    except TimeoutError as error:
        raise ExposureNotReached(f"{device.name}: not within {WITHIN_S:g} s") from error


async def _search(device: Chosen, aim: ExposureAim, radii_px: tuple[float, float]) -> float:
    search = ExposureSearch(aim)
    exposed = await device.expose()
    wanted_s = aim.within(exposed.views[0].exposure_s or _FIRST_S)
    for _ in range(MOST_EXPOSURES):
        exposure_s = await device.device.set_exposure(wanted_s)
        exposed = await device.expose()
        light = await asyncio.to_thread(_light, exposed, radii_px)
        verdict = search.judge(exposure_s, light)
        if verdict.shortfall:
            raise ExposureNotReached(f"{device.name}: {verdict.shortfall}")
        if verdict.next_s is None:
            return exposure_s
        wanted_s = verdict.next_s
    raise ExposureNotReached(f"{device.name}: not in {MOST_EXPOSURES} exposures")


def _light(exposed: Exposed, radii_px: tuple[float, float]) -> Brightness:
    return of_all([light_round_holes(view.grey, radii_px) for view in exposed.views])
