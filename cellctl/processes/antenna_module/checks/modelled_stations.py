"""Holds tray, socket and reference plate against the model of the cell."""

from collections.abc import Iterator
from typing import cast

from cellctl.config.cell import CellConfig
from cellctl.config.checks.arms.modelled_places import unmodelled_issues
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.model_file import StatedModel
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM
from cellctl.processes.antenna_module.settings import AntennaSettings


def modelled_station_issues(
    cell: CellConfig, recipe: AntennaRecipe, key: str, model: StatedModel
) -> Iterator[ConfigIssue]:
    """A station that the model has elsewhere, or not at all."""
    places = {
        f"{key}.base_T_tray_plug.pose": recipe.base_T_tray_plug.pose,
        f"{key}.base_T_socket.pose": recipe.base_T_socket.pose,
    }
    reference = cast(AntennaSettings, cell.processes[recipe.process]).reference
    if reference is not None:
        where = f"processes.{recipe.process}.reference.base_T_plate.pose"
        places[where] = reference.base_T_plate.pose
    for where, pose in places.items():
        written = WrittenValue(where, str(list(pose)))
        yield from unmodelled_issues(model, recipe.device(ARM), written, pose_from_xyzabc(pose))
