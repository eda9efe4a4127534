"""The cameras of a scenario as the fake GenTL producer shows them: each lens is one of its own."""

from collections.abc import Iterator

from fakes.gentl.cameras import FakeCamera
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import Camera, SingleCamera, StereoCamera


def shown(scenario: Scenario) -> dict[str, tuple[FakeCamera, ...]]:
    """Cameras by the name of their device; a head has two, the left one first."""
    return {
        name: tuple(_lenses(name, camera, scenario.optics_of(name).image_px))
        for name, camera in scenario.all_cameras().items()
    }


def _lenses(name: str, camera: Camera, size_px: tuple[int, int]) -> Iterator[FakeCamera]:
    if isinstance(camera, StereoCamera):
        for side, serial in zip(("left", "right"), camera.serials, strict=True):
            yield FakeCamera(serial, f"{name}_{side}", *size_px)
        return
    colour = isinstance(camera, SingleCamera) and camera.colour
    yield FakeCamera(camera.serial, name, *size_px, pixel_format="RGB8" if colour else "Mono8")
