"""What `cellctl check` finds wrong with a recipe in a cell, beyond its keys."""

from collections.abc import Iterator
from typing import cast

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.errors import CellError
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.plausible.seat import seat_order_issues
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ARM, FORCE
from cellctl.processes.peg_in_hole.settings import PegSettings


def recipe_issues(cell: CellConfig, recipe: PegRecipe, key: str) -> Iterator[ConfigIssue]:
    """A sensor on another arm, forces in a wrong order, a search that cannot find the hole."""
    arm, sensor = recipe.device(ARM), recipe.device(FORCE)
    mounted_on = cell.force_sensors[sensor].mounted_on
    if mounted_on != arm:
        where = f"force_sensors.{sensor}.mounted_on"
        yield ConfigIssue(where, repr(mounted_on), f"the robot that carries the peg: {arm}")
    forces = recipe.forces
    if not forces.search_n <= forces.insertion_n < forces.fault_n:
        found = f"{forces.search_n:g}, {forces.insertion_n:g}, {forces.fault_n:g}"
        yield ConfigIssue(f"{key}.forces", found, "search_n <= insertion_n < fault_n")
    yield from seat_order_issues(recipe.seat, f"{key}.seat")
    try:
        cycle_plan(recipe, cast(PegSettings, cell.processes[recipe.process]))
    except CellError as fault:
        yield ConfigIssue(key, str(fault), "a hole that one of the searches finds")
