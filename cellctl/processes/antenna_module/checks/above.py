"""Holds tray, socket and plug of a recipe against the poses that were taught over them."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.places.over_places import (
    ChainedPose,
    Over,
    over_place_issues,
    unmeasured_height,
)
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.mated import MATED_TURN
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ABOVE_SOCKET, ABOVE_TRAY, ARM


def above_issues(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """A plug that is not over its tray or its socket where the arm was taught to be over them."""
    for over in _taught(cell, recipe, key):
        yield from over_place_issues(cell, over)


def above_remarks(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Places over which no pose was taught, or with a height that nobody measured."""
    arm, taught = recipe.device(ARM), _taught(cell, recipe, key)
    for pose in (ABOVE_TRAY, ABOVE_SOCKET):
        if pose not in cell.robots[arm].poses_deg:
            said = (
                "the plug over its place, in the attitude in which it goes there; without it "
                "nothing holds flange_T_plug and that place of the recipe against the cell before "
                "contact"
            )
            yield ConfigIssue(f"robots.{arm}.poses_deg", f"{pose} (missing)", said)
    for over in taught:
        yield from unmeasured_height(cell, over)


def _taught(cell: CellConfig, recipe: AntennaRecipe, key: str) -> list[Over]:
    """The plug over those of its places over which a pose was taught."""
    arm, itself = recipe.device(ARM), RigidTransform.identity()
    plug = ChainedPose(f"{key}.flange_T_plug", recipe.flange_T_plug)
    places = {
        ABOVE_TRAY: (f"{key}.base_T_tray_plug", recipe.base_T_tray_plug, itself),
        ABOVE_SOCKET: (f"{key}.base_T_socket", recipe.base_T_socket, MATED_TURN),
    }
    return [
        Over(
            arm,
            pose,
            pose_from_xyzabc(recipe.flange_T_plug),
            pose_from_xyzabc(place.pose) * place_T_plug,
            where,
            (ChainedPose(f"{where}.pose", place.pose, after=place_T_plug),),
            (plug,),
            height_mm=place.taught_above_mm,
        )
        for pose, (where, place, place_T_plug) in places.items()
        if pose in cell.robots[arm].poses_deg
    ]
