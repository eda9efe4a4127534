"""Figures of a peg, its hole and its cell that do not go together."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import cast

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound, at_most
from cellctl.config.checks.bounds.contradiction import contradictions
from cellctl.config.checks.places.flange_places import deepest_mm, flange_place_issues
from cellctl.config.checks.places.over_places import over_place_issues
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.recipe import Recipe
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
    figures = list(contradictions(cell, recipe, key, partial(_bounds, key=key, folder=folder)))
    yield from figures
    if places or figures:
        return  # ways that follow from a wrong place or drawing would be named again
    above = list(over_place_issues(cell, over_hole(recipe, key)))
    yield from above
    if not above:
        yield from stream_issues(cell, recipe, settings, key)


def _bounds(cell: CellConfig, recipe: Recipe, key: str, folder: Path) -> Iterator[Bound]:
    known, settings = cast(PegRecipe, recipe), cast(PegSettings, cell.processes[recipe.process])
    yield from fit_bounds(known, key)
    yield from force_bounds(cell, known, settings, key)
    yield from loop_bounds(cell, known, settings, folder)


def _places(cell: CellConfig, recipe: PegRecipe, key: str) -> Iterator[ConfigIssue]:
    """A hole out of the arm's reach."""
    tip_T_flange = pose_from_xyzabc(recipe.flange_T_tip).inv()

    def flange_at(depth_mm: float) -> RigidTransform:
        below = RigidTransform.from_translation([0.0, 0.0, depth_mm * MM])
        return tip_at_hole(recipe) * below * tip_T_flange

    arm, depth_mm = recipe.device(ARM), recipe.fit.depth_mm
    hole = WrittenValue(f"{key}.base_T_hole.pose", str(list(recipe.base_T_hole.pose)))
    tip = WrittenValue(f"{key}.flange_T_tip", str(list(recipe.flange_T_tip)))
    at_the_face = list(flange_place_issues(cell, arm, (hole, tip), {"at the face": flange_at(0.0)}))
    yield from at_the_face
    if not at_the_face:
        # The face is in reach, so the depth is wrong before the place of the hole is.
        most_mm = deepest_mm(cell, arm, flange_at, depth_mm)
        depth = WrittenValue(f"{key}.fit.depth_mm", f"{depth_mm:g}", allowed=at_most(most_mm))
        seat = {"at the seat": flange_at(depth_mm)}
        yield from flange_place_issues(cell, arm, (depth, hole, tip), seat)
