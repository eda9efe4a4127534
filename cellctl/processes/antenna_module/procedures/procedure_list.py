"""The procedures of Maintenance that this process offers, with their numbers."""

from collections.abc import Awaitable, Callable, Sequence
from datetime import timedelta
from functools import partial

from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.processes.antenna_module.procedures import guides
from cellctl.processes.antenna_module.procedures.camera_intrinsics import (
    calibrate_camera_on_cell,
)
from cellctl.processes.antenna_module.procedures.camera_mounting import (
    calibrate_mounting_on_cell,
)
from cellctl.processes.antenna_module.procedures.teach_plug import teach_plug_on_cell
from cellctl.processes.antenna_module.procedures.teach_reference import (
    teach_reference_on_cell,
)
from cellctl.processes.antenna_module.procedures.touch_tool import touch_tool_on_cell
from cellctl.processes.antenna_module.procedures.turn_tool import turn_tool_on_cell
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.guide import Guide
from cellctl.runtime.procedure import Procedure, ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices

TEACH = 206
TEACH_BY_RECIPE = 20_600
"""Plus the number of a recipe: its plug correction; 206 means the first recipe."""

Run = Callable[[ProcedureContext], Awaitable[ProcedureOutcome | None]]


def antenna_procedures(
    cell: AntennaCell, recipes: Sequence[AntennaRecipe], services: CellServices
) -> Sequence[Procedure]:
    """All procedures of the cell whose devices are given, and of its recipes."""
    valid_for = timedelta(days=cell.settings.validity_days)
    by_number = {TEACH: recipes[0]}
    by_number |= {TEACH_BY_RECIPE + recipe.id: recipe for recipe in recipes}

    def procedure(number: int, label: str, guide: Guide, run: Run) -> Procedure:
        return Procedure(number, number, label, run, valid_for, guide=guide)

    in_hand, to_hand = Setup.EYE_IN_HAND, Setup.EYE_TO_HAND
    cameras = [
        procedure(
            201,
            "calibrate camera I",
            guides.CAMERA_1,
            partial(calibrate_camera_on_cell, cell, in_hand),
        ),
        procedure(
            202,
            "calibrate camera II",
            guides.CAMERA_2,
            partial(calibrate_camera_on_cell, cell, to_hand),
        ),
        procedure(
            203,
            "camera I on the flange",
            guides.ON_FLANGE,
            partial(calibrate_mounting_on_cell, cell, services, in_hand),
        ),
        procedure(
            204,
            "camera II beside the robot",
            guides.BESIDE,
            partial(calibrate_mounting_on_cell, cell, services, to_hand),
        ),
    ]
    section = cell.settings.reference
    if section is not None:
        teach = partial(teach_reference_on_cell, cell, recipes[0], section, services)
        cameras.append(procedure(205, "teach reference", guides.TAUGHT, teach))
    turn = partial(turn_tool_on_cell, cell, recipes[0], services)
    tool = [
        procedure(207, "tool by turning", guides.TURNED, turn),
        procedure(208, "tool by touches", guides.TOUCHED, partial(touch_tool_on_cell, cell)),
    ]
    return [*cameras, *tool] + [
        Procedure(
            number,
            TEACH,
            "teach plug",
            partial(teach_plug_on_cell, cell, recipe, services),
            valid_for,
            handles_parts=True,
            guide=guides.plugged(recipe.id),
        )
        for number, recipe in by_number.items()
    ]
