"""`cellctl robot`: what one robot says of itself. Moves nothing."""

import asyncio
import json
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import typer

from cellctl.cell.robot_reports import listen
from cellctl.cli.cell_daemon import client_of
from cellctl.cli.commissioning.one_robot import cell_with, connected
from cellctl.cli.nearest_cell import SocketOption
from cellctl.cli.operator.no_end import without_end
from cellctl.clock import utc_now
from cellctl.config import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import motion_bounds
from cellctl.errors.local import DaemonNotReached, MessageMalformed
from cellctl.procedures.stop_latency import stored_stop_latencies
from cellctl.terminal.consoles import console_of_lines

Heard = dict[str, dict[str, Any]]


def robot(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    name: Annotated[str, typer.Argument(help="The robot's name there.")],
    *,
    seconds: Annotated[float, typer.Option(min=0.5, max=600.0, help="How long to listen.")] = 3.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    socket: SocketOption = None,
) -> None:
    """Listen to one robot and print what it says. Moves nothing.

    Asks the daemon of this cell where one runs and is connected. Else it connects by itself, and
    its links end with the command: the robot is then latched, until the daemon has re-armed it.
    """
    cell = cell_with(cell_file, name)
    heard = _from_daemon(cell, name, seconds, socket)
    source = "asked through the daemon"
    if heard is None:
        heard, source = asyncio.run(_from_robot(cell, name, seconds)), "connected without a daemon"
    heard["load"] = _load(cell.robots[name])
    heard["stop_latency"] = _stop_latency(cell, cell_file, name)
    if as_json:
        typer.echo(json.dumps({"source": source, **heard}, indent=2))
        return
    console = console_of_lines()
    driver = cell.robots[name].driver
    console.print(f"{name} by {driver}, {source}: nothing was moved")
    for part, values in heard.items():
        console.print(part.replace("_", " "))
        for key, value in values.items():
            console.print(f"  {key:24} {_text(value)}")


def _from_daemon(cell: CellConfig, name: str, seconds: float, socket: Path | None) -> Heard | None:
    """What the daemon of this cell hears; None where none runs, or it is not connected."""
    try:
        answer = client_of(cell, socket).robot(name, seconds)
    except (DaemonNotReached, MessageMalformed):
        return None
    # A service of another cell may run on this PC.
    return answer.heard if answer.cell == cell.name else None


async def _from_robot(cell: CellConfig, name: str, seconds: float) -> Heard:
    async with connected(cell, name) as (one, connect_s):
        heard = (await listen(one, seconds)).as_json()
    heard["link"] = {"connected_after_s": round(connect_s, 3), **heard["link"]}
    return heard


def _stop_latency(cell: CellConfig, cell_file: Path, name: str) -> dict[str, Any]:
    """What was measured, of a robot that carries a force sensor: only of such a one it is."""
    if all(sensor.mounted_on != name for sensor in cell.force_sensors.values()):
        return {}
    folder = cell_file.parent / cell.calibration_dir
    return {
        f"{stored.kind} of {stored.made:%Y-%m-%d %H:%M}": f"at most {stored.upper_ms:.0f} ms, "
        f"{_validity(stored.valid_until)}"
        for stored in stored_stop_latencies(folder)
    } or {"stored": "none; the bound of the recipe counts"}


def _validity(valid_until: datetime) -> str:
    if without_end(valid_until, utc_now()):
        return "valid without end"
    return f"valid until {valid_until:%Y-%m-%d %H:%M} UTC"


def _load(robot: RobotConfig) -> dict[str, Any]:
    stated, most_kg = robot.load, motion_bounds(robot).load_kg
    shown: dict[str, Any] = {"in_the_cell_file": "none stated"}
    if stated is not None:
        com = ", ".join(f"{value:g}" for value in stated.com_mm)
        shown["in_the_cell_file"] = f"{stated.mass_kg:g} kg at {com} mm of the flange"
        shown["may_differ_by"] = f"{stated.tolerance_kg:g} kg, {stated.tolerance_mm:g} mm"
    return shown if most_kg is None else shown | {"at_most": f"{most_kg:g} kg"}


def _text(value: object) -> str:
    if isinstance(value, list):
        return "  ".join(f"{number:.3f}" for number in value)
    return str(value)
