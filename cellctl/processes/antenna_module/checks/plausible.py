"""Places of an antenna recipe that the arm cannot come to."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config.cell import CellConfig
from cellctl.config.checks.flange_places import flange_place_issues
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM

_OVER = RigidTransform.from_rotation(Rotation.from_rotvec([3.141592653589793, 0.0, 0.0]))
"""A plug in its socket: their z axes point against each other."""


def plausible_issues(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
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
