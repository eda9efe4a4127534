"""Out of the socket without a run: after a Stop, or after a restart that knows nothing of it."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.cell.guarded_motion.kept_zero import Pressed
from cellctl.cell.guarded_motion.leaving import change_while_drawn_n, pressed_n
from cellctl.errors.force import ForceLimitExceeded, LiftOffHeld
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits, InsertionPhase
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

_INWARDS = -1.0
"""In the frame of a run, z of the plug points out of the socket."""
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
    socket = read_connector(cell.cell.folder / recipe.socket)
    press_n = await pressed_n(cell.arm, _INWARDS, _most_pressed_n(recipe, socket, here))
    try:
        async with guarded_moves(
            cell.cell,
            cell.arm,
            flange_T_plug * MATED_TURN,
            _tolerance(socket, press_n),
            leaves=Pressed(_INWARDS, press_n),
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
    x_m, y_m, height_m = _place_m(recipe, base_T_flange)
    if max(abs(x_m), abs(y_m)) > _BESIDE_M:
        return 0.0
    return max(0.0, recipe.insertion.stand_off_mm * MM + _uncertain_m(recipe) - height_m)


def _place_m(recipe: AntennaRecipe, base_T_flange: RigidTransform) -> tuple[float, float, float]:
    """The plug over the face of the socket, as both are stated."""
    base_T_face = nominal(recipe.base_T_socket)
    place = base_T_face.inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_plug)
    x_m, y_m, height_m = place.translation.tolist()
    return x_m, y_m, height_m


def _uncertain_m(recipe: AntennaRecipe) -> float:
    sigma_mm = float(np.hypot(recipe.base_T_socket.height_sigma_mm, recipe.plug_height_sigma_mm))
    return recipe.insertion.height_sigmas * sigma_mm * MM


def _most_pressed_n(
    recipe: AntennaRecipe, socket: Connector, base_T_flange: RigidTransform
) -> float:
    """Greatest force (N) with which a run may have left the plug pressed where it stands."""
    limits = InsertionLimits.of(socket)
    _, _, height_m = _place_m(recipe, base_T_flange)
    # The place is stated, and the contact springs may come earlier than drawn.
    at_most_m = 2 * _uncertain_m(recipe) - height_m
    if limits.phase_at(at_most_m) is InsertionPhase.SLIDING:
        return limits.at(at_most_m).axial_n
    # A few newtons have stopped a plug that has not come to its springs, and the stop took a while.
    return limits.entry_most_n + limits.over_n


def _tolerance(socket: Connector, press_n: float) -> WrenchTolerance:
    """As after a fault of the contact: what the plug is pressed with may go, then it is pulled."""
    limits = InsertionLimits.of(socket)
    lever_m = max(socket.outline_m) / 2.0
    return WrenchTolerance(
        force_n=SIDE_N + limits.sliding_side_n,
        moment_n_m=MOMENT_N_M + abs(press_n) * lever_m,
        axial_n=change_while_drawn_n(PULL_RATIO * limits.greatest_n, press_n),
    )
