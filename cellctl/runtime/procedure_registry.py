"""Which procedure, with the parts of which recipe, a number of the line asks for."""

from dataclasses import dataclass

from cellctl.config import CellConfig
from cellctl.processes.deck_to_frame.recipe import Recipe
from cellctl.runtime.step import Step

STIFFNESS_BY_RECIPE = 100 * Step.MEASURE_CONTACT_STIFFNESS
"""10 800 + recipe id; the plain number means the first recipe."""
_FIRST = Step.CALIBRATE_HEAD_1


@dataclass(frozen=True, slots=True)
class ProcedureOrder:
    """What to do."""

    step: Step
    recipe: Recipe
    """Of the parts on the station; matters to contact stiffness alone."""


def procedure_order(number: int, config: CellConfig) -> ProcedureOrder | None:
    """The order behind a number, or None when there is no such procedure or recipe."""
    recipe = config.recipe(number - STIFFNESS_BY_RECIPE)
    if recipe is not None:
        return ProcedureOrder(Step.MEASURE_CONTACT_STIFFNESS, recipe)
    if number < _FIRST or number not in set(Step):
        return None
    return ProcedureOrder(Step(number), config.recipes[0])
