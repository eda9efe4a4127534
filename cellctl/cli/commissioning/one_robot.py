"""One robot of a cell file, connected without the daemon. Nothing here moves it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, cast

import numpy as np

from cellctl.clock import now_s
from cellctl.config import CellConfig, load_cell
from cellctl.config.robot_drivers import robot_driver
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import pose_to_xyzabc
from cellctl.interfaces import Robot, RobotState

ANY_AGE_S = 1e9


@asynccontextmanager
async def connected(cell: CellConfig, name: str) -> AsyncIterator[tuple[Robot, float]]:
    """The robot, and how many seconds its connection took; its links are dropped at the end.

    Raises what the driver raises: ``PortInUse`` while a daemon holds the robot.
    """
    driver, settings = robot_driver(cell.robots[name])
    robot = cast(Robot, cast(Any, driver)(name, settings))
    began_s = now_s()
    try:
        await robot.connect()
        yield robot, now_s() - began_s
    finally:
        await robot.disconnect()


def cell_with(cell_file: Path, name: str) -> CellConfig:
    """The cell file, which has such a robot; else ``FileInvalid`` with those that it has."""
    cell = load_cell(cell_file)
    if name not in cell.robots:
        raise FileInvalid(f"{cell_file} has no robot {name!r}; it has {', '.join(cell.robots)}")
    return cell


def state_as_json(state: RobotState) -> dict[str, Any]:
    """A state in the units of the cell file: mm and degrees, angles A, B, C of Rz Ry Rx."""
    return {
        "mode": state.mode.value,
        "emergency_stop": state.emergency_stop,
        "drives_on": state.drives_on,
        "moving": state.moving,
        "stop_latched": state.stop_latched,
        "error_code": state.error_code,
        "error_words": state.error_words,
        "override_percent": round(100.0 * state.speed_override_ratio, 1),
        "flange_xyzabc_mm_deg": [round(float(v), 4) for v in pose_to_xyzabc(state.base_T_flange)],
        "joints_deg": joints_deg(state),
    }


def joints_deg(state: RobotState) -> list[float]:
    """Joints in degrees, as they are written in a cell file."""
    return [round(float(angle), 5) + 0.0 for angle in np.degrees(state.joints_rad)]
