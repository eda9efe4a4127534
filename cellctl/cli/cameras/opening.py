"""Finds the camera or the stereo head that a command names, and takes exposures of it."""

from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import typer
from numpy.typing import NDArray

from cellctl.cell.driver_object import driver_object
from cellctl.cell.lighting.lit_cameras import Lights
from cellctl.config import CellConfig, load_cell
from cellctl.config.devices import CameraConfig
from cellctl.errors.config import DeviceNotInCell
from cellctl.interfaces import Camera, DigitalIo, StereoCamera
from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image, StereoPair
from cellctl.vision.camera.depth import eight_bit_grey

CellFile = Annotated[Path, typer.Argument(help="The cell's TOML file.")]
HeadName = Annotated[str | None, typer.Option(help="A stereo head of the cell file.")]
CameraName = Annotated[str | None, typer.Option(help="A single camera of the cell file.")]
_HEADS, _CAMERAS = "stereo_cameras", "cameras"


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One image of an exposure."""

    side: str
    """``left`` or ``right`` of a head; empty for a single camera."""
    pixels: NDArray[Any]
    """The image as the driver gives it; red comes first where it is coloured."""
    pixel_format: PixelFormat
    exposure: ExposureRecord | None

    @property
    def exposure_s(self) -> float | None:
        """Exposure that the camera states; None where it states none, or sets it by itself."""
        return None if self.exposure is None else self.exposure.exposure_s

    @property
    def grey(self) -> Image:
        """Reduced to 8 bit grey, shape (height, width)."""
        return eight_bit_grey(self.pixels, self.pixel_format, self.exposure)


@dataclass(frozen=True, slots=True)
class Exposed:
    """One exposure of a head or a camera."""

    views: tuple[View, ...]
    time_s: float
    """Monotonic."""
    frame_id: int


@dataclass(frozen=True, slots=True)
class Chosen:
    """The device of a command, not connected."""

    name: str
    driver: str
    device: Camera | StereoCamera
    light: DigitalIo | None = None
    """The digital I/O that switches its lamp."""

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[Camera | StereoCamera]:
        """Connected inside, with the digital I/O of its lamp; raises what their drivers raise."""
        async with AsyncExitStack() as stack:
            # The camera first. One that a running daemon has (F222) ends the command before it
            # touches outputs, which all go off when their link is let go.
            await stack.enter_async_context(self.device)
            if self.light is not None:
                await stack.enter_async_context(self.light)
            yield self.device

    async def expose(self) -> Exposed:
        """Take one exposure; raises what the driver raises."""
        taken = await self.device.grab()
        views = _pair(taken) if isinstance(taken, StereoPair) else _single(taken)
        return Exposed(views, taken.time_s, taken.frame_id)


def chosen(cell_file: Path, head: str | None, camera: str | None) -> Chosen:
    """The device that a command names; raises ``DeviceNotInCell`` or a fault of the cell file."""
    if (head is None) == (camera is None):
        raise typer.BadParameter("give one of --head NAME and --camera NAME")
    cell = load_cell(cell_file)
    section, name = (_HEADS, head) if head is not None else (_CAMERAS, camera or "")
    sections: Mapping[str, CameraConfig] = cell.cameras if head is None else cell.stereo_cameras
    found = sections.get(name)
    if found is None:
        raise DeviceNotInCell(f"{cell_file} has no {section}.{name}; {_there_is(cell)}")
    built = driver_object(section, name, found)
    if found.light is None:
        return Chosen(name, found.driver, built)
    io_name = found.light.device
    io: DigitalIo = driver_object("digital_ios", io_name, cell.digital_ios[io_name])
    lights = Lights({io_name: io})
    lit = lights.heads if head is not None else lights.cameras
    return Chosen(name, found.driver, lit({name: built}, {name: found})[name], io)


def _there_is(cell: CellConfig) -> str:
    names = {option: cell.section(section) for option, section in _OPTIONS.items()}
    there = [f"{option} {', '.join(found)}" for option, found in names.items() if found]
    return "it has " + ("; ".join(there) or "no camera")


_OPTIONS = {"--head": _HEADS, "--camera": _CAMERAS}


def _single(image: CameraImage) -> tuple[View, ...]:
    return (View("", image.pixels, image.pixel_format, image.exposure),)


def _pair(pair: StereoPair) -> tuple[View, ...]:
    left, right = pair.exposures or (None, None)
    one = View("left", pair.left, PixelFormat.MONO8, left)
    return one, replace(one, side="right", pixels=pair.right, exposure=right)
