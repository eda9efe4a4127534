"""Procedure 207: where the gripper's marks are beside the flange axis, by turning over camera II.

Only the scale of camera II enters, and how well the arm repeats: no hand-eye calibration, no touch.
"""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import LimitCheck
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.antenna_module.calibrations import CALIBRATIONS, TOOL_TURN
from cellctl.processes.antenna_module.chain.reference.reference_looks import turn_angles
from cellctl.processes.antenna_module.chain.teaching.tool_turn import (
    ToolTurnResult,
    TurnStop,
    calibrate_tool_turn,
)
from cellctl.processes.antenna_module.chain.teaching.turn_picture import turn_picture
from cellctl.processes.antenna_module.facts import read_facts
from cellctl.processes.antenna_module.looking import Eyes
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.start import leave_stations
from cellctl.processes.antenna_module.moves.turning import TurnDrive
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import HOME
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices

LOOKS = 8
_FROM_DRAWING_M = 1e-3
"""Marks that are farther from where the recipe draws them are another gripper's, or bent."""


async def turn_tool_on_cell(
    cell: AntennaCell, recipe: AntennaRecipe, services: CellServices, context: ProcedureContext
) -> ProcedureOutcome:
    """Turn the empty gripper over camera II and look at its marks.

    Raises ``TurnInvalid``, and what drive and store raise.
    """
    facts = await read_facts(cell, recipe, services.calibrations, CALIBRATIONS, teaching=True)
    await leave_stations(cell)
    await cell.gripper.open()
    turning = TurnDrive(facts, Eyes(cell.arm, cell.workers, recorder=None, frames=1), Mover(cell))
    stops: list[TurnStop] = []
    in_flange_m: list[Array] = []
    for number, angle_rad in enumerate(turn_angles(LOOKS), start=1):
        await context.progress(number, LOOKS, "look")
        stops.append(await turning.stop(angle_rad, f"turn-{number}"))
        in_flange_m.append(_in_flange(cell.arm.robot.state().base_T_flange, stops[-1]))
    await Mover(cell).to_taught(HOME)
    result = _held_against_drawing(calibrate_tool_turn(stops), np.mean(in_flange_m, axis=0), recipe)
    return ProcedureOutcome(
        kind=TOOL_TURN,
        record=result.to_record(),
        passed=result.passed,
        warnings=(),
        picture_png=await cell.workers.run(turn_picture, result),
        serial_number="",
    )


def _in_flange(base_T_flange: RigidTransform, stop: TurnStop) -> Array:
    """The marks in the axes of the flange, shape (2,). What camera II is wrong by is turned with
    them, and drops out of the mean over both half turns."""
    seen_m = np.append(stop.seen_m, 0.0)
    return np.asarray(base_T_flange.rotation.inv().apply(seen_m))[:2]


def _held_against_drawing(
    result: ToolTurnResult, in_flange_m: Array, recipe: AntennaRecipe
) -> ToolTurnResult:
    drawn_m = pose_from_xyzabc(recipe.flange_T_marks).translation[:2]
    beside_m = float(np.linalg.norm(in_flange_m - drawn_m))
    check = LimitCheck("marks beside their drawing", beside_m / MM, _FROM_DRAWING_M / MM, "mm")
    return replace(result, checks=(*result.checks, check))
