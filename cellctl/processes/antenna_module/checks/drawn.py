"""Holds limits of a recipe against its drawings, and the drawings against each other."""

from collections.abc import Iterator
from pathlib import Path

from cellctl.config.checks.bound import Bound
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.drawings import read_drawings
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.settings import ReferenceSection


def contact_bounds(recipe: AntennaRecipe, key: str, folder: Path) -> Iterator[Bound]:
    """Offsets at which a pin no longer finds its hole; called with drawings that can be read."""
    capture_mm = read_drawings(recipe, folder).socket.capture_m / MM
    why = "capture_mm of the socket's drawing: farther off a pin meets the face beside its hole"
    for name in ("worst_contact_mm", "seated_limit_mm"):
        yield Bound(f"{key}.{name}", float(getattr(recipe, name)), why, most=capture_mm)


def one_file_twice(
    recipe: AntennaRecipe, key: str, reference: ReferenceSection | None, where: str
) -> Iterator[ConfigIssue]:
    """One drawing for two things that are not the same."""
    if recipe.gripper_marks == recipe.module_top:
        allowed = "the marks on top of the module; gripper_marks names this file, too"
        yield ConfigIssue(f"{key}.module_top", repr(recipe.module_top), allowed)
    if reference is not None and reference.plate_above == reference.plate_below:
        allowed = "the dots as camera II sees them; plate_above names this file, too"
        yield ConfigIssue(f"{where}.reference.plate_below", repr(reference.plate_below), allowed)
