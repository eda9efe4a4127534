"""What may be meant as it stands in a recipe of this process, and is worth a second look."""

from collections.abc import Iterator
from math import pi
from pathlib import Path
from typing import cast

from cellctl.config.cell import CellConfig
from cellctl.config.checks.arms.tool_floor import tool_floor_remarks
from cellctl.config.checks.places.over_places import unmeasured_height
from cellctl.config.checks.places.sensor_places import straight_mm
from cellctl.config.issue import ConfigIssue
from cellctl.processes.peg_in_hole.plan.cycle_plan import search_task
from cellctl.processes.peg_in_hole.plausible.fit import far_touches, wide_clearance
from cellctl.processes.peg_in_hole.plausible.loop import soft_arm
from cellctl.processes.peg_in_hole.plausible.stream import over_hole
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ARM, FORCE
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.verdict.lateral import push_force_n

_ROUGH = 0.5
"""Friction of clean, dry metal; parts that are plugged are smoother, or one is a plastic."""
_SLENDER_MM = 25.0
"""Diameter of a bar that is slenderer than grippers are; fingers and their bodies are wider."""
_ALUMINIUM_KG_MM3, _STEEL_KG_MM3 = 2.7e-6, 7.85e-6


def recipe_remarks(
    cell: CellConfig, recipe: PegRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Called with a file that is good."""
    settings = cast(PegSettings, cell.processes[recipe.process])
    fit = recipe.fit
    if (said := wide_clearance(fit)) is not None:
        yield ConfigIssue(f"{key}.fit.clearance_mm", f"{fit.clearance_mm:g}", said)
    if (said := far_touches(recipe)) is not None:
        written = f"{recipe.base_T_hole.face_radius_mm:g}"
        yield ConfigIssue(f"{key}.base_T_hole.face_radius_mm", written, said)
    if fit.friction > _ROUGH:
        push_n = push_force_n(search_task(recipe, settings).cell)
        said = (
            "more than parts have that are plugged; right if it was measured: the verdict pushes "
            f"the part sideways with {push_n:.0f} N, since less could be friction on a chamfer"
        )
        yield ConfigIssue(f"{key}.fit.friction", f"{fit.friction:g}", said)
    if fit.keys is not None and fit.keys.window_deg >= fit.keys.uncertainty_deg:
        said = (
            f"keys that enter within {fit.keys.window_deg:g} deg need no turn when the plug "
            f"arrives within uncertainty_deg = {fit.keys.uncertainty_deg:g}; right if it is so"
        )
        yield ConfigIssue(f"{key}.fit.keys.window_deg", f"{fit.keys.window_deg:g}", said)
    if fit.keys is None and fit.outer_radius_mm is not None:
        said = (
            "a raised plug seldom is round all over: keys that are left out are met as a stop, and "
            "the part is never turned; right if it has none"
        )
        yield ConfigIssue(f"{key}.fit.keys", "(missing)", said)
    if recipe.seat.grip_n is None:
        said = "nothing is called inserted without it: measure at which force the part slips"
        yield ConfigIssue(f"{key}.seat.grip_n", "(missing)", said)
    yield from _light(cell, recipe, key)
    yield from unmeasured_height(cell, over_hole(recipe, key))
    yield from soft_arm(cell, recipe, settings, folder)
    yield from tool_floor_remarks(cell, recipe.device(ARM), recipe.flange_T_tip)


def _light(cell: CellConfig, recipe: PegRecipe, key: str) -> Iterator[ConfigIssue]:
    """A load that hardly anything weighs which reaches from the sensor to the tip.

    Nothing of the process weighs it: the zero is taken upright, and a part that is tilted in the
    search shows what is missing as a push to the side.
    """
    reach_mm = straight_mm(recipe.flange_T_tip)
    if reach_mm is None:
        return
    long_mm = reach_mm - cell.force_sensors[recipe.device(FORCE)].flange_T_sensor[2]
    least_kg = _ALUMINIUM_KG_MM3 * pi / 4.0 * _SLENDER_MM**2 * long_mm
    if recipe.load.mass_kg < least_kg:
        fit = recipe.fit
        part_kg = _STEEL_KG_MM3 * pi * fit.peg_radius_mm**2 * fit.depth_mm
        said = (
            f"gripper and part together, in kg; a bar of aluminium of {_SLENDER_MM:g} mm from the "
            f"sensor to the tip ({long_mm:g} mm) weighs {least_kg:.2f}, and a steel part of "
            f"peg_radius_mm and depth_mm alone {part_kg:.2g}. What is missing acts as a push when "
            "the search tilts the part: weigh it; right if the tool is so light"
        )
        yield ConfigIssue(f"{key}.load.mass_kg", f"{recipe.load.mass_kg:g}", said)


def not_yet_checked(recipe: PegRecipe) -> Iterator[str]:
    """How deep the touched panel lies below the face of a raised plug: a rule alone shows it."""
    deep_mm = recipe.base_T_hole.datum_depth_mm
    if deep_mm > 0.0:
        yield (
            f"recipe {recipe.id}: base_T_hole.datum_depth_mm = {deep_mm:g}. Nothing in the file "
            "says how far the plug stands proud of the panel that is touched round it. Measure "
            "it: by as much as it is wrong the plug's face is met too soon or too late"
        )
