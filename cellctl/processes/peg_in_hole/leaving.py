"""Brings the arm home, out of the hole first where a run has left it there."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.free_moves import move_joint_free
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import HOME
from cellctl.processes.peg_in_hole.stations import PegCell, peg_recipes, weight_of

CLEAR_OF_FACE_M = 15e-3
"""Height over the face from which on a joint move may begin."""
_BESIDE_M = 50e-3
"""Farther than this from the axis of a hole nothing stands in the way."""
_TWIST_N_M = 2.0
_SLOW_M_S, _SLOW_M_S2 = 5e-3, 0.05


async def leave_hole(cell: PegCell) -> None:
    """Along the axis of the hole until the peg is clear of it, then home; raises the guard's trip.

    There is no gripper in the process: the part comes along, as it is held.
    """
    recipes = peg_recipes(cell.cell.config)
    # After a restart nobody remembers which recipe has run, so each is asked whether the tip is in
    # its hole.
    for recipe in recipes:
        await _out_of(cell, recipe)
    if recipes:
        await cell.arm.guard.set_gravity_compensation(weight_of(recipes[0]))
    home_rad = np.radians(cell.arm.config.poses_deg[HOME])
    await move_joint_free(cell.cell, cell.arm, home_rad)


async def _out_of(cell: PegCell, recipe: PegRecipe) -> None:
    base_T_hole = pose_from_xyzabc(recipe.base_T_hole.pose)
    here = cell.robot.state().base_T_flange
    tip = base_T_hole.inv() * here * pose_from_xyzabc(recipe.flange_T_tip)
    x_m, y_m, height_m = tip.translation.tolist()
    uncertain_m = recipe.base_T_hole.height_uncertainty_mm * MM
    missing_m = CLEAR_OF_FACE_M + uncertain_m - height_m
    if np.hypot(x_m, y_m) > _BESIDE_M or missing_m <= 0:
        return
    # Along the axis of the hole: in any other direction a tight peg would jam.
    up = base_T_hole.rotation.apply([0.0, 0.0, missing_m])
    target = RigidTransform.from_translation(up) * here
    wrench_frame = pose_from_xyzabc(recipe.flange_T_tip)
    # More, and the part is held, which is for a person to see.
    pull = WrenchTolerance(recipe.forces.withdrawal_n, _TWIST_N_M)
    async with guarded_moves(cell.cell, cell.arm, wrench_frame, pull) as move:
        await move(
            cell.robot.move_linear(target, speed_m_s=_SLOW_M_S, acceleration_m_s2=_SLOW_M_S2)
        )
    # Those were the limits of a pull; the move home arms limits of its own.
    await cell.arm.guard.disarm()
