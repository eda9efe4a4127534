"""Brings the arm to where every run begins, and out of wherever it was left."""

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.faults.plugging import ModuleInGripper
from cellctl.processes.antenna_module.looking import nominal
from cellctl.processes.antenna_module.mated import MATED_TURN
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.places import raised
from cellctl.processes.antenna_module.pushing.draw_out import draw_out
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import HOME
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import GripperEmpty
from cellctl.processes.antenna_module.stations import AntennaCell

_BESIDE_M = 60e-3
"""Flange so near a place of plug or tray, seen from above, may have its fingers round a module."""


async def move_to_start(run: PluggingRun) -> GripperEmpty:
    """Gripper empty and open, arm at home. Raises ``ModuleInGripper``."""
    run.say("to the beginning")
    await leave_stations(run.cell)
    # Only after ``leave_stations`` has refused a gripper that holds something, which would fall.
    await run.cell.gripper.open()
    return GripperEmpty(run)


async def leave_stations(cell: AntennaCell) -> None:
    """Straight up from tray or socket, a plug slowly out of its socket first; then home.

    Raises ``ModuleInGripper`` after that: the operator takes the module out where it is reached,
    and nothing begins with it.
    """
    state = await cell.gripper.state()
    holding = state.part_present and not state.opened
    if holding:
        for recipe in cell.recipes:
            await draw_out(cell, recipe)
    mover = Mover(cell)
    height_m = _height_to_leave_m(cell)
    if height_m > 0:
        here = cell.arm.robot.state().base_T_flange
        await mover.slowly_to(raised(here, height_m))
    await mover.to_taught(HOME)
    if holding:
        raise ModuleInGripper("the gripper is closed on a part")


def _height_to_leave_m(cell: AntennaCell) -> float:
    """How far up the way home begins; 0 away from tray and socket."""
    here = cell.arm.robot.state().base_T_flange
    return max(
        (
            _missing_m(here, recipe, base_T_plug)
            for recipe in cell.recipes
            for base_T_plug in (
                nominal(recipe.base_T_tray_plug),
                nominal(recipe.base_T_socket) * MATED_TURN,
            )
        ),
        default=0.0,
    )


def _missing_m(here: RigidTransform, recipe: AntennaRecipe, base_T_plug: RigidTransform) -> float:
    at_place = base_T_plug * pose_from_xyzabc(recipe.flange_T_plug).inv()
    x_m, y_m, height_m = (here.translation - at_place.translation).tolist()
    if max(abs(x_m), abs(y_m)) > _BESIDE_M:
        return 0.0
    return max(0.0, recipe.grip_approach_mm * MM - float(height_m))
