"""The procedures of Maintenance that this process offers, with their numbers."""

from collections.abc import Sequence
from datetime import timedelta
from functools import partial

from cellctl.processes.antenna_module.procedures.teach_plug import teach_plug_on_cell
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import Procedure
from cellctl.runtime.process import CellServices

TEACH = 206
TEACH_BY_RECIPE = 20_600
"""Plus the number of a recipe: its plug correction; 206 means the first recipe."""


def antenna_procedures(
    cell: AntennaCell, recipes: Sequence[AntennaRecipe], services: CellServices
) -> Sequence[Procedure]:
    """All procedures of the cell whose devices are given, and of its recipes."""
    valid_for = timedelta(days=cell.settings.validity_days)
    by_number = {TEACH: recipes[0]}
    by_number |= {TEACH_BY_RECIPE + recipe.id: recipe for recipe in recipes}
    return [
        Procedure(
            number,
            TEACH,
            "teach plug",
            partial(teach_plug_on_cell, cell, recipe, services),
            valid_for,
        )
        for number, recipe in by_number.items()
    ]
