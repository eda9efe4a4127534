"""Out of the socket without a run: after a Stop, or after a restart that knows nothing of it."""

from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.cell.guarded_motion.leaving import pressed_n
from cellctl.errors.force import ForceLimitExceeded, LiftOffHeld
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.looking import nominal
from cellctl.processes.antenna_module.mated import MATED_TURN
from cellctl.processes.antenna_module.pushing.back_out import (
    ACCELERATION_M_S2,
    MOMENT_N_M,
    PULL_RATIO,
    SIDE_N,
    SPEED_M_S,
)
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell

_BESIDE_M = 5e-3
"""Farther than this from the axis of a socket the plug is not in it: a place that is stated in a
recipe is good to far less than a millimetre."""


async def draw_out(cell: AntennaCell, recipe: AntennaRecipe) -> None:
    """With the module in the gripper, slowly along the plug's axis to the stand-off.

    Moves nothing where the plug would not be in its socket. Raises ``LiftOffHeld`` when the plug
    does not come, what the file of the socket raises, and the faults of guard and robot.
    """
    here = cell.arm.robot.state().base_T_flange
    way_m = way_out_m(recipe, here)
    if way_m == 0:
        return
    flange_T_plug = pose_from_xyzabc(recipe.flange_T_plug)
    # As the plug stands and not as the socket is stated: it was turned to its socket to go in.
    inwards = (here * flange_T_plug).rotation.apply([0.0, 0.0, 1.0])
    target = RigidTransform.from_translation(-way_m * inwards) * here
    tolerance = await _tolerance(cell, recipe)
    try:
        async with guarded_moves(
            cell.cell, cell.arm, flange_T_plug * MATED_TURN, tolerance
        ) as move:
            await move(
                cell.arm.robot.move_linear(
                    target, speed_m_s=SPEED_M_S, acceleration_m_s2=ACCELERATION_M_S2
                )
            )
    except ForceLimitExceeded as fault:
        raise LiftOffHeld(f"while drawing the plug out of its socket: {fault.detail}") from fault


def way_out_m(recipe: AntennaRecipe, base_T_flange: RigidTransform) -> float:
    """From where the plug would be in its socket to the stand-off over it; 0 away from there."""
    base_T_face = nominal(recipe.base_T_socket)
    place = base_T_face.inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_plug)
    x_m, y_m, height_m = place.translation.tolist()
    if max(abs(x_m), abs(y_m)) > _BESIDE_M:
        return 0.0
    insertion = recipe.insertion
    uncertain_mm = insertion.height_sigmas * recipe.base_T_socket.height_sigma_mm
    return max(0.0, (insertion.stand_off_mm + uncertain_mm) * MM - float(height_m))


async def _tolerance(cell: AntennaCell, recipe: AntennaRecipe) -> WrenchTolerance:
    """As after a fault of the contact: what the plug is pressed with may go, then it is pulled."""
    socket = read_connector(cell.cell.folder / recipe.socket)
    limits = InsertionLimits.of(socket)
    as_a_run_may_n = limits.at(limits.seat_depth_m).axial_n
    # In the frame of a run, z of the plug points out of the socket.
    press_n = await pressed_n(cell.arm.guard, -1.0, as_a_run_may_n)
    lever_m = max(socket.outline_m) / 2.0
    return WrenchTolerance(
        force_n=SIDE_N + limits.sliding_side_n,
        moment_n_m=MOMENT_N_M + press_n * lever_m,
        axial_n=PULL_RATIO * limits.greatest_n + press_n,
    )
