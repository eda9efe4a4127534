"""Figures of a peg, its hole and its cell that do not go together."""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bound import bound_issues
from cellctl.config.checks.flange_places import flange_place_issues
from cellctl.config.checks.over_places import over_place_issues
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.peg_in_hole.plausible.fit import fit_bounds
from cellctl.processes.peg_in_hole.plausible.forces import force_bounds
from cellctl.processes.peg_in_hole.plausible.loop import loop_bounds
from cellctl.processes.peg_in_hole.plausible.stream import over_hole, stream_issues
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ARM
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import tip_at_hole


def plausible_issues(
    cell: CellConfig, recipe: PegRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Called with a recipe in which nothing else is wrong."""
    settings = cast(PegSettings, cell.processes[recipe.process])
    places = list(_places(cell, recipe, key))
    yield from places
    figures = list(bound_issues(fit_bounds(recipe, key)))
    yield from figures
    yield from bound_issues(force_bounds(cell, recipe, settings, key))
    yield from bound_issues(loop_bounds(cell, recipe, settings, folder))
    if places or figures:
        return  # ways that follow from a wrong place or drawing would be named again
    above = list(over_place_issues(cell, over_hole(recipe, key)))
    yield from above
    if not above:
        yield from stream_issues(cell, recipe, settings, key)


def _places(cell: CellConfig, recipe: PegRecipe, key: str) -> Iterator[ConfigIssue]:
    """A hole out of the arm's reach."""
    tip_T_flange = pose_from_xyzabc(recipe.flange_T_tip).inv()
    places = {
        what: tip_at_hole(recipe)
        * RigidTransform.from_translation([0.0, 0.0, depth_mm * MM])
        * tip_T_flange
        for what, depth_mm in (("at the face", 0.0), ("at the seat", recipe.fit.depth_mm))
    }
    written = f"{key}.base_T_hole.pose", str(list(recipe.base_T_hole.pose))
    yield from flange_place_issues(cell, recipe.device(ARM), written, places)
