"""`cellctl grab`: images of one camera or head as files, each with a record of its exposure."""

import asyncio
import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import cv2
import typer
from rich.progress import Progress

from cellctl.calibration.output_file import write_file
from cellctl.cli.cameras.opening import (
    CameraName,
    CellFile,
    Chosen,
    Exposed,
    HeadName,
    View,
    chosen,
)
from cellctl.clock import utc_now
from cellctl.errors.config import FileInvalid
from cellctl.files.atomic_files import make_folder_durably
from cellctl.interfaces.camera import PixelFormat

_QUICK = [cv2.IMWRITE_PNG_COMPRESSION, 1]
"""Still lossless: the level changes size and time only."""


def grab(
    cell_file: CellFile,
    *,
    out: Annotated[Path, typer.Option(help="Folder for the images; made if need be.")],
    head: HeadName = None,
    camera: CameraName = None,
    count: Annotated[int, typer.Option(help="Exposures.", min=1, max=100_000)] = 1,
) -> None:
    """Save images as PNG, each exposure with a JSON file; moves nothing, overwrites nothing."""
    device = chosen(cell_file, head, camera)
    first = _first_free(out, device.name)
    last = asyncio.run(_save(device, out, first, count))
    typer.echo(f"{out}: {device.name}-{first:06d} to {device.name}-{last:06d}")


async def _save(device: Chosen, folder: Path, first: int, count: int) -> int:
    last = first + count - 1
    async with device.opened() as camera:
        serial_number = await camera.serial_number()
        with Progress(transient=True) as progress:
            for number in progress.track(range(first, last + 1), description=device.name):
                exposed = await device.expose()
                stem = f"{device.name}-{number:06d}"
                # Beside the event loop: a driver may have a link to keep alive.
                await asyncio.to_thread(_write, folder, stem, device, serial_number, exposed)
    return last


def _write(folder: Path, stem: str, device: Chosen, serial_number: str, exposed: Exposed) -> None:
    images: list[dict[str, Any]] = []
    for view in exposed.views:
        name = "-".join(filter(None, (stem, view.side))) + ".png"
        write_file(folder / name, _png(view))
        images.append({"file": name, "shape": list(view.pixels.shape)} | _facts(view))
    record = {
        "device": device.name,
        "driver": device.driver,
        "serial_number": serial_number,
        "utc": utc_now().isoformat(),
        "monotonic_s": exposed.time_s,
        "frame_id": exposed.frame_id,
        "images": images,
    }
    # Last: a record tells that its images are whole.
    write_file(folder / f"{stem}.json", (json.dumps(record, indent=2) + "\n").encode())


def _facts(view: View) -> dict[str, Any]:
    facts: dict[str, Any] = {} if view.exposure is None else asdict(view.exposure)
    return {"format": view.pixel_format.value, "exposure": facts or None}


def _png(view: View) -> bytes:
    """Lossless, 8 or 16 bit, with the samples as they are."""
    pixels = view.pixels
    if view.pixel_format in (PixelFormat.RGB8, PixelFormat.RGB16):
        pixels = cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR)
    done, data = cv2.imencode(".png", pixels, _QUICK)
    if not done:
        raise FileInvalid("the image could not be encoded as PNG")
    return data.tobytes()


def _first_free(folder: Path, name: str) -> int:
    """The number after those of an earlier call; raises ``FileInvalid`` for no usable folder."""
    try:
        make_folder_durably(folder)
        files = [path.name.removeprefix(f"{name}-") for path in folder.glob(f"{name}-*")]
    except OSError as error:
        raise FileInvalid(f"cannot write {folder}: {error.strerror or error}") from error
    # Six digits are the least: the millionth image has seven.
    numbers = [found.group() for file in files if (found := re.match(r"\d{6,}", file))]
    return max(map(int, numbers), default=0) + 1
