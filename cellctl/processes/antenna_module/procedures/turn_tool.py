"""Procedure 207: where the gripper's marks are beside the flange axis, by turning over camera II.

Only the scale of camera II enters, and how well the arm repeats: no hand-eye calibration, no touch.
"""

from collections.abc import Sequence
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
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.start import leave_stations
from cellctl.processes.antenna_module.moves.turning import TurnDrive
from cellctl.processes.antenna_module.procedures.board_drive import eyes_of
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
    turning = TurnDrive(facts, eyes_of(context, cell), Mover(cell))
    stops: list[TurnStop] = []
    flanges: list[RigidTransform] = []
    for number, angle_rad in enumerate(turn_angles(LOOKS), start=1):
        await context.progress(number, LOOKS, "look")
        stops.append(await turning.stop(angle_rad, f"turn-{number}"))
        flanges.append(cell.arm.robot.state().base_T_flange)
    await Mover(cell).to_taught(HOME)
    drawn_m = pose_from_xyzabc(recipe.flange_T_marks).translation[:2]
    await context.keep_input(
        {
            "base_T_cam2": facts.plug_cell.cam2.pose.pose.as_matrix().tolist(),
            "drawn_m": drawn_m.tolist(),
            "marks": [look.to_input() for look in turning.kept],
            "base_T_flange": [flange.as_matrix().tolist() for flange in flanges],
        }
    )
    result = turned_tool(stops, flanges, drawn_m)
    return ProcedureOutcome(
        kind=TOOL_TURN,
        record=result.to_record(),
        passed=result.passed,
        warnings=(),
        picture_png=await cell.workers.run(turn_picture, result),
        serial_number="",
    )


def turned_tool(
    stops: Sequence[TurnStop], base_T_flange: Sequence[RigidTransform], drawn_m: Array
) -> ToolTurnResult:
    """The marks beside the axis, held against their drawing: ``drawn_m`` of shape (2,).

    Raises ``TurnInvalid``.
    """
    result = calibrate_tool_turn(stops)
    in_flange_m = np.mean(list(map(_in_flange, base_T_flange, stops)), axis=0)
    beside_m = float(np.linalg.norm(in_flange_m - drawn_m))
    check = LimitCheck("marks beside their drawing", beside_m / MM, _FROM_DRAWING_M / MM, "mm")
    return replace(result, checks=(*result.checks, check))


def _in_flange(base_T_flange: RigidTransform, stop: TurnStop) -> Array:
    """The marks in the axes of the flange, shape (2,). What camera II is wrong by is turned with
    them, and drops out of the mean over both half turns."""
    seen_m = np.append(stop.seen_m, 0.0)
    return np.asarray(base_T_flange.rotation.inv().apply(seen_m))[:2]
