"""What a run hands on to whoever judges its curve later."""

from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.cycle import CyclePlan, greatest_before_n
from cellctl.processes.peg_in_hole.offline.task_file import (
    FeltSection,
    JudgedCellSection,
    JudgedPart,
)
from cellctl.processes.peg_in_hole.recipe import PegRecipe


def judged_part(recipe: PegRecipe, plan: CyclePlan, face_yields_m: float) -> JudgedPart:
    """The content of a task file for one run, with the loop that was measured."""
    cell = plan.task.cell
    return JudgedPart(
        fit=recipe.fit,
        seat=recipe.seat,
        cell=JudgedCellSection(
            stiffness_n_mm=cell.stiffness_n_m * MM, force_sigma_n=cell.force_sigma_n
        ),
        felt=FeltSection(
            face_yields_mm=face_yields_m / MM, greatest_n=greatest_before_n(plan.task)
        ),
    )
