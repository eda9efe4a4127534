"""Brings the arm home, out of the hole first where it is in one; shows what the tip feels there."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.free_moves import move_joint_free
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.cell.guarded_motion.kept_zero import Pressed
from cellctl.cell.guarded_motion.leaving import change_while_drawn_n, pressed_n
from cellctl.errors.force import ForceLimitExceeded, LiftOffHeld
from cellctl.force.contact.leaving import FIRST_LIFT_M
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import HOME
from cellctl.processes.peg_in_hole.stations import PegCell, weight_of

CLEAR_OF_FACE_M = 15e-3
"""Height over the face from which on a joint move may begin."""
_BESIDE_M = 50e-3
"""Farther than this from the axis of a hole nothing stands in the way. Nothing is touched there
either, unless the circle of the touches is wider."""
_INWARDS = 1.0
"""Sign of z of the tip along the way into the hole, in the frame of a run."""
_TWIST_N_M = 2.0
"""Largest change of a moment while the part is drawn out: what the study allows the insertion of a
connector (section 1 of the study of insertion by touch)."""
_SLOW_M_S, _SLOW_M_S2 = 5e-3, 0.05
"""Speed at which the study retracts from a hole (section 2), and an acceleration that reaches it
within half a millimetre."""
_FIRST_M_S = 1e-3
"""Speed of the first stretch. A part that is held is pulled by k v T more until the arm stands:
18 N with the 120 N/mm and the 150 ms of the fake cells, and 90 N at the speed of the rest."""
_FIRST_RATIO = 2.0
"""So many times the way on which a part that is held reaches the limit of the guard, for an arm of
half the stiffness that is stated as its upper bound."""


async def leave_hole(cell: PegCell) -> None:
    """Along the axis of the hole until the peg is clear of it, then home; raises ``LiftOffHeld``
    for a part that does not come or that an earlier attempt has left pulled, and the faults of
    guard and robot.

    There is no gripper in the process: the part comes along, as it is held.
    """
    guard, press_n = cell.arm.guard, 0.0
    held = recipe_in_hole(cell)
    if held is not None:
        press_n = await pressed_n(cell.arm, _INWARDS, held.forces.insertion_n)
        # Before anything changes: what is pulled already must stay known.
        change_while_drawn_n(held.forces.withdrawal_n, press_n)
    # A run that was stopped has left it armed, and an armed guard takes no other load.
    await guard.disarm()
    # A load that is set drops the zero, and with it what is known of a pull. So on the way out the
    # load of the run stays; a guard that has none was started anew, and its zero is not known.
    if not guard.gravity_compensated:
        await _subtract_weight(cell, held)
    # After a restart nobody remembers which recipe has run, so each is asked whether the tip is in
    # its hole.
    for recipe in cell.recipes:
        await _out_of(cell, recipe, press_n)
    await _subtract_weight(cell, held)
    home_rad = np.radians(cell.arm.config.poses_deg[HOME])
    await move_joint_free(cell.cell, cell.arm, home_rad)


async def show_force_on_tip(cell: PegCell) -> None:
    """Have the guard subtract what hangs on its sensor, and give the force in the axes of the tip.

    Away from every hole the axes stay those of the sensor. No tare: the tip may be in contact.
    Raises the faults of guard and robot.
    """
    held = recipe_in_hole(cell)
    await _subtract_weight(cell, held)
    if held is not None:
        flange_T_tip = pose_from_xyzabc(held.flange_T_tip)
        await cell.arm.guard.set_wrench_frame(cell.arm.flange_T_sensor.inv() * flange_T_tip)


async def _subtract_weight(cell: PegCell, held: PegRecipe | None) -> None:
    """Have the guard subtract what the recipe hangs on its sensor; away from every hole the first
    recipe's, and nothing in a cell without one."""
    if cell.recipes:
        await cell.arm.guard.set_gravity_compensation(weight_of(held or cell.recipes[0]))


def recipe_in_hole(cell: PegCell) -> PegRecipe | None:
    """The first recipe whose tip would be in its hole, or low over it."""
    here = cell.robot.state().base_T_flange
    return next((recipe for recipe in cell.recipes if _missing_m(recipe, here) > 0), None)


def _missing_m(recipe: PegRecipe, base_T_flange: RigidTransform) -> float:
    """How far out a tip has to go along the axis of the hole; 0 away from it."""
    base_T_hole = pose_from_xyzabc(recipe.base_T_hole.pose)
    tip = base_T_hole.inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_tip)
    x_m, y_m, height_m = tip.translation.tolist()
    place = recipe.base_T_hole
    touched_m = (place.face_radius_mm + place.uncertainty_mm) * MM
    if np.hypot(x_m, y_m) > max(_BESIDE_M, touched_m):
        return 0.0
    uncertain_m = place.height_uncertainty_mm * MM
    return max(0.0, CLEAR_OF_FACE_M + uncertain_m - float(height_m))


async def _out_of(cell: PegCell, recipe: PegRecipe, press_n: float) -> None:
    here = cell.robot.state().base_T_flange
    missing_m = _missing_m(recipe, here)
    if missing_m == 0:
        return
    # Along the axis of the hole: in any other direction a tight peg would jam.
    base_T_hole = pose_from_xyzabc(recipe.base_T_hole.pose)
    up = base_T_hole.rotation.apply([0.0, 0.0, 1.0])
    wrench_frame = pose_from_xyzabc(recipe.flange_T_tip)
    # More, and the part is held, which is for a person to see. What it is pressed with goes first.
    pull_n = recipe.forces.withdrawal_n
    change_n = change_while_drawn_n(pull_n, press_n)
    pull = WrenchTolerance(pull_n, _TWIST_N_M, axial_n=change_n)
    held_m = change_n / cell.settings.stiffness_n_mm * MM
    first_m = max(FIRST_LIFT_M, _FIRST_RATIO * held_m)
    stretches = [(min(first_m, missing_m), _FIRST_M_S)]
    if first_m < missing_m:
        stretches.append((missing_m, _SLOW_M_S))
    try:
        async with guarded_moves(
            cell.cell, cell.arm, wrench_frame, pull, leaves=Pressed(_INWARDS, press_n)
        ) as move:
            for height_m, speed_m_s in stretches:
                target = RigidTransform.from_translation(height_m * up) * here
                await move(
                    cell.robot.move_linear(
                        target, speed_m_s=speed_m_s, acceleration_m_s2=_SLOW_M_S2
                    )
                )
    except ForceLimitExceeded as fault:
        raise LiftOffHeld(f"while drawing the part out of its hole: {fault.detail}") from fault
    # Those were the limits of a pull; the move home arms limits of its own.
    await cell.arm.guard.disarm()
