"""Procedures 301 and 302, for the first recipe and by the number of each."""

from collections.abc import Callable, Coroutine, Sequence
from datetime import timedelta
from functools import partial
from typing import Any

from cellctl.processes.peg_in_hole.procedures import guides
from cellctl.processes.peg_in_hole.procedures.contact_loop import measure_loop_on_cell
from cellctl.processes.peg_in_hole.procedures.panel import take_panel_reference
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.runtime.guide import Guide
from cellctl.runtime.procedure import Procedure, ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices

LOOP, PANEL = 301, 302
BY_RECIPE = 100
"""Times the number of the procedure, plus that of a recipe; the bare number means the first one."""

_OnCell = Callable[
    [PegCell, PegRecipe, CellServices, ProcedureContext], Coroutine[Any, Any, ProcedureOutcome]
]
_PROCEDURES: dict[int, tuple[str, _OnCell, Callable[[int], Guide]]] = {
    LOOP: ("measure contact loop", measure_loop_on_cell, guides.loop),
    PANEL: ("take panel reference", take_panel_reference, guides.panel),
}


def peg_procedures(
    cell: PegCell, recipes: Sequence[PegRecipe], services: CellServices
) -> Sequence[Procedure]:
    """All procedures of the cell whose devices are given."""
    return [
        Procedure(
            number,
            kind,
            label,
            partial(run, cell, recipe, services),
            timedelta(days=cell.settings.validity_days),
            contact=True,
            guide=guide(recipe.id),
        )
        for kind, (label, run, guide) in _PROCEDURES.items()
        for number, recipe in _numbered(kind, recipes)
    ]


def _numbered(kind: int, recipes: Sequence[PegRecipe]) -> list[tuple[int, PegRecipe]]:
    return [(kind, recipes[0]), *((BY_RECIPE * kind + recipe.id, recipe) for recipe in recipes)]
