"""What `cellctl check` finds wrong with a recipe in a cell, beyond its keys."""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.errors import CellError
from cellctl.processes.antenna_module.drawings import read_drawings, read_plate
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM, CAMERA_1, CAMERA_2, FORCE, REFERENCE_LOOK
from cellctl.processes.antenna_module.settings import AntennaSettings


def recipe_issues(
    cell: CellConfig, recipe: AntennaRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Drawings that cannot be used, and devices that are mounted elsewhere."""
    arm = recipe.device(ARM)
    sensor = recipe.device(FORCE)
    if cell.force_sensors[sensor].mounted_on != arm:
        where = f"force_sensors.{sensor}.mounted_on"
        found = repr(cell.force_sensors[sensor].mounted_on)
        yield ConfigIssue(where, found, f"the robot that carries the gripper: {arm}")
    for role, carrier in ((CAMERA_1, arm), (CAMERA_2, None)):
        camera = recipe.device(role)
        carried_by = cell.cameras[camera].carried_by
        if carried_by != carrier:
            where = f"cameras.{camera}.carried_by"
            wanted = "nobody: camera II is fixed" if carrier is None else carrier
            yield ConfigIssue(where, repr(carried_by), wanted)
    if cell.cameras[recipe.device(CAMERA_1)].flange_T_camera is None:
        where = f"cameras.{recipe.device(CAMERA_1)}.flange_T_camera"
        yield ConfigIssue(where, "nothing", "the camera's place on the flange by the drawing")
    try:
        read_drawings(recipe, folder)
    except CellError as fault:
        yield ConfigIssue(key, fault.detail, "drawings that can be used")
    yield from _reference_issues(cell, recipe, folder)


def _reference_issues(
    cell: CellConfig, recipe: AntennaRecipe, folder: Path
) -> Iterator[ConfigIssue]:
    settings = cast(AntennaSettings, cell.processes[recipe.process])
    if settings.reference is None:
        return
    arm = recipe.device(ARM)
    if REFERENCE_LOOK not in cell.robots[arm].poses_deg:
        where = f"robots.{arm}.poses_deg"
        yield ConfigIssue(where, "nothing", f"{REFERENCE_LOOK}: camera I over the reference plate")
    try:
        read_plate(settings.reference, folder)
    except CellError as fault:
        where = f"processes.{recipe.process}.reference"
        yield ConfigIssue(where, fault.detail, "drawings that can be used")
