"""Places of an antenna recipe that the arm cannot come to, and figures that no arm has."""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bound import bound_issues
from cellctl.config.checks.flange_places import flange_place_issues
from cellctl.config.checks.over_places import Over, over_place_issues
from cellctl.config.checks.sensor_places import sensor_bounds
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.checks.drawn import contact_bounds, one_file_twice
from cellctl.processes.antenna_module.checks.figures import arm_bounds, board_bounds
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM, CAMERA_1, FORCE, SOCKET_LOOK, TRAY_LOOK
from cellctl.processes.antenna_module.settings import AntennaSettings

_OVER = RigidTransform.from_rotation(Rotation.from_rotvec([3.141592653589793, 0.0, 0.0]))
"""A plug in its socket: their z axes point against each other."""


def plausible_issues(
    cell: CellConfig, recipe: AntennaRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Called with a recipe in which nothing else is wrong."""
    settings, arm = cast(AntennaSettings, cell.processes[recipe.process]), recipe.device(ARM)
    where = f"processes.{recipe.process}"
    yield from one_file_twice(recipe, key, settings.reference, where)
    yield from bound_issues(contact_bounds(recipe, key, folder))
    yield from bound_issues(arm_bounds(cell, arm, settings, where))
    yield from bound_issues(sensor_bounds(cell, recipe.device(FORCE), recipe.flange_T_plug))
    yield from bound_issues(board_bounds(cell, settings, where, folder))
    places = list(_places(cell, recipe, key))
    yield from places
    if not places:
        yield from _looks(cell, recipe, key)


def _looks(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Poses from which camera I does not see what it is taught to look at."""
    name = recipe.device(CAMERA_1)
    written = cell.cameras[name].flange_T_camera
    if written is None:
        return
    camera = WrittenValue(f"cameras.{name}.flange_T_camera", str(list(written)))
    tray = pose_from_xyzabc(recipe.base_T_tray_plug.pose)
    places = {
        TRAY_LOOK: ("base_T_tray_plug", tray * pose_from_xyzabc(recipe.plug_T_top) * _OVER),
        SOCKET_LOOK: ("base_T_socket", pose_from_xyzabc(recipe.base_T_socket.pose) * _OVER),
    }
    for pose, (place, base_T_seen) in places.items():
        pose_written = WrittenValue(f"{key}.{place}.pose", str(list(getattr(recipe, place).pose)))
        over = Over(
            recipe.device(ARM),
            pose,
            pose_from_xyzabc(written),
            base_T_seen,
            (pose_written, camera),
            any_turn=True,
        )
        yield from over_place_issues(cell, over)


def _places(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Tray and socket against the box of the flange."""
    plug_T_flange = pose_from_xyzabc(recipe.flange_T_plug).inv()
    places = {
        "base_T_tray_plug": ("when it picks", recipe.base_T_tray_plug.pose, None),
        "base_T_socket": ("with the plug in the socket", recipe.base_T_socket.pose, _OVER),
    }
    for name, (what, written, turn) in places.items():
        base_T_plug = pose_from_xyzabc(written)
        if turn is not None:
            base_T_plug = base_T_plug * turn
        yield from flange_place_issues(
            cell,
            recipe.device(ARM),
            (f"{key}.{name}.pose", str(list(written))),
            {what: base_T_plug * plug_T_flange},
        )
