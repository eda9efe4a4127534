"""`cellctl focus`: live figures of a camera or head while a person sets it up."""

import asyncio
import json
import signal
from collections.abc import Coroutine
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from typing import Annotated

import typer
from pydantic import ValidationError
from rich.live import Live

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.cell.lighting.auto_exposure import Looked, found_exposure
from cellctl.cli.cameras.focus_screen import screen
from cellctl.cli.cameras.focus_view import FocusView, HolesWanted, looked_at
from cellctl.cli.cameras.opening import CameraName, CellFile, Chosen, HeadName, chosen
from cellctl.clock import now_s
from cellctl.config.devices import AutoExposureConfig
from cellctl.terminal.consoles import console_of_tables
from cellctl.vision.camera.exposure_search import light_round_holes, of_all


def focus(
    cell_file: CellFile,
    *,
    head: HeadName = None,
    camera: CameraName = None,
    board: Annotated[
        str | None, typer.Option(help="Look for a chessboard: inner corners, such as 9x6.")
    ] = None,
    hole_px: Annotated[
        tuple[float, float] | None,
        typer.Option(help="Look for dark round holes: least and greatest radius, px."),
    ] = None,
    auto: Annotated[
        bool,
        typer.Option("--auto", help="First set the exposure by the grey round holes (--hole-px)."),
    ] = False,
    target_grey: Annotated[
        float, typer.Option(help="Of --auto, in grey values of 8 bit.", min=20.0, max=240.0)
    ] = 180.0,
    exposure_ms: Annotated[
        tuple[float, float], typer.Option(help="Of --auto: least and greatest exposure.")
    ] = (0.02, 200.0),
    once: Annotated[bool, typer.Option("--once", help="One exposure, one table.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One exposure, as JSON.")] = False,
) -> None:
    """Show sharpness, light, overlap and what is found, live until Ctrl-C; moves nothing."""
    pattern = None if board is None else _board(board)
    wanted = _wanted(target_grey, exposure_ms, hole_px) if auto else None
    device = chosen(cell_file, head, camera)
    if as_json:
        seen = asyncio.run(_one(device, pattern, hole_px, wanted))
        typer.echo(json.dumps(asdict(seen), indent=2))
    elif once:
        console_of_tables().print(
            screen(device.name, asyncio.run(_one(device, pattern, hole_px, wanted)))
        )
    else:
        # Ctrl-C is how this command ends; the camera is let go on the way out.
        with suppress(KeyboardInterrupt):
            asyncio.run(_follow(device, pattern, hole_px, wanted))


async def _one(
    device: Chosen,
    board: CalibrationBoard | None,
    holes: HolesWanted,
    wanted: AutoExposureConfig | None,
) -> FocusView:
    async with device.opened():
        await _set_exposure(device, wanted)
        return await _look(device, board, holes)


async def _follow(
    device: Chosen,
    board: CalibrationBoard | None,
    holes: HolesWanted,
    wanted: AutoExposureConfig | None,
) -> None:
    sharpest: dict[str, float] = {}
    ended = asyncio.Event()
    # Not by the cancellation that a Ctrl-C is otherwise: one that meets a finished wait is lost on
    # Python 3.11, and the command would go on for ever.
    asyncio.get_running_loop().add_signal_handler(signal.SIGINT, ended.set)
    async with device.opened():
        await _set_exposure(device, wanted)
        with Live(auto_refresh=False) as live:
            while seen := await _unless(ended, _look(device, board, holes)):
                for one in seen.sides:
                    if one.figures.blur_px is not None:
                        before = sharpest.get(one.side, one.figures.blur_px)
                        sharpest[one.side] = min(before, one.figures.blur_px)
                live.update(screen(device.name, seen, sharpest), refresh=True)


async def _set_exposure(device: Chosen, wanted: AutoExposureConfig | None) -> None:
    if wanted is not None:
        found = await found_exposure(device.device, wanted, partial(_light, device, wanted.hole_px))
        # Beside the figures, which a program reads.
        typer.echo(f"{device.name}: settings.exposure_s = {found.exposure_s:.6g}", err=True)


async def _light(device: Chosen, hole_px: tuple[float, float]) -> Looked:
    views = (await device.expose()).views
    light = [await asyncio.to_thread(light_round_holes, view.grey, hole_px) for view in views]
    return Looked(views[0].exposure_s, of_all(light))


async def _unless(ended: asyncio.Event, look: Coroutine[None, None, FocusView]) -> FocusView | None:
    """The next view; None as soon as the command is to end."""
    looking = asyncio.ensure_future(look)
    ending = asyncio.ensure_future(ended.wait())
    try:
        await asyncio.wait({looking, ending}, return_when=asyncio.FIRST_COMPLETED)
        return None if ended.is_set() else await looking
    finally:
        looking.cancel()
        ending.cancel()
        await asyncio.wait({looking, ending})


async def _look(device: Chosen, board: CalibrationBoard | None, holes: HolesWanted) -> FocusView:
    began_s = now_s()
    exposed = await device.expose()
    took_s = now_s() - began_s
    return await asyncio.to_thread(looked_at, exposed, took_s, board, holes)


def _wanted(
    target_grey: float, exposure_ms: tuple[float, float], holes: HolesWanted
) -> AutoExposureConfig:
    if holes is None:
        raise typer.BadParameter("--auto needs --hole-px: it looks at the surface round the holes")
    try:
        return AutoExposureConfig(hole_px=holes, target_grey=target_grey, exposure_ms=exposure_ms)
    except ValidationError as error:
        first = error.errors()[0]
        option = str(first["loc"][0]).replace("_", "-")
        raise typer.BadParameter(f"--{option}: {first['msg']}") from error


def _board(corners: str) -> CalibrationBoard:
    try:
        columns, rows = (int(part) for part in corners.lower().split("x"))
        # The size of the squares does not matter for finding them.
        return CalibrationBoard(columns, rows, square_m=1.0)
    except ValueError as error:
        raise typer.BadParameter(f"--board {corners}: inner corners such as 9x6") from error
