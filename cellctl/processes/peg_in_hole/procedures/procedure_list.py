"""Procedure 301, for the first recipe and by the number of each."""

from collections.abc import Sequence
from datetime import timedelta
from functools import partial

from cellctl.processes.peg_in_hole.procedures.contact_loop import measure_loop_on_cell
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.runtime.procedure import Procedure
from cellctl.runtime.process import CellServices

LOOP = 301
LOOP_BY_RECIPE = 30_100
"""Plus the number of a recipe; 301 means the first one."""


def peg_procedures(
    cell: PegCell, recipes: Sequence[PegRecipe], services: CellServices
) -> Sequence[Procedure]:
    """All procedures of the cell whose devices are given."""
    by_number = {LOOP: recipes[0]}
    by_number |= {LOOP_BY_RECIPE + recipe.id: recipe for recipe in recipes}
    return [
        Procedure(
            number,
            LOOP,
            "measure contact loop",
            partial(measure_loop_on_cell, cell, recipe, services),
            timedelta(days=cell.settings.validity_days),
            contact=True,
        )
        for number, recipe in by_number.items()
    ]
