"""One robot of a cell file, connected without the daemon. Nothing here moves it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, cast

from cellctl.clock import now_s
from cellctl.config import CellConfig, load_cell
from cellctl.config.driver_settings import robot_driver
from cellctl.errors.config import DeviceNotInCell
from cellctl.interfaces import Robot


@asynccontextmanager
async def connected(cell: CellConfig, name: str) -> AsyncIterator[tuple[Robot, float]]:
    """The robot, and how many seconds its connection took; its links are dropped at the end.

    Raises what the driver raises: ``PortInUse`` while a daemon holds the robot.
    """
    driver, settings = robot_driver(cell.robots[name])
    robot = cast(Robot, cast(Any, driver)(name, settings))
    began_s = now_s()
    # Inside, because a connection that fails half-way has links to be dropped, too.
    try:
        await robot.connect()
        yield robot, now_s() - began_s
    finally:
        await robot.disconnect()


def cell_with(cell_file: Path, name: str) -> CellConfig:
    """The cell file, which has such a robot; else ``DeviceNotInCell`` with those that it has."""
    cell = load_cell(cell_file)
    if name not in cell.robots:
        known = ", ".join(cell.robots)
        raise DeviceNotInCell(f"{cell_file} has no robot {name!r}; it has {known}")
    return cell
