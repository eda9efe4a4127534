"""Procedure 302: where the arm meets the face, to which every later run compares its own touch."""

from cellctl.calibration.checks import evidence_to_record
from cellctl.processes.peg_in_hole.calibrations import PANEL_REFERENCE
from cellctl.processes.peg_in_hole.panel_reference import PanelReference
from cellctl.processes.peg_in_hole.procedures.after_the_face import after_the_face
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.state import FaceTouched
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices
from cellctl.runtime.steps import StepSpec

_METHOD = "three touches of the face and a fourth that proves them"


async def take_panel_reference(
    cell: PegCell, recipe: PegRecipe, services: CellServices, context: ProcedureContext
) -> ProcedureOutcome:
    """Touch the face as a run does and keep its plane in the base of the arm.

    Raises what the steps raise: a face that is uneven or tilted is no reference.
    """
    take = StepSpec(302, "take panel reference", _take)
    panel, number = await after_the_face(cell, recipe, services, context, take)
    return ProcedureOutcome(
        kind=PANEL_REFERENCE.for_recipe(recipe.id),
        record={
            **evidence_to_record(_METHOD, ()),
            "recipe_id": recipe.id,
            "run": number,
            **panel.to_record(),
        },
        passed=True,
        warnings=(),
        picture_png=None,
        serial_number="",
    )


async def _take(touched: FaceTouched) -> PanelReference:
    return PanelReference.of(touched.frames.base_T_task)
