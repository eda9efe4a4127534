"""Holds the place of the hole against the model of the cell."""

from collections.abc import Iterator

from cellctl.config.checks.arms.modelled_places import unmodelled_issues
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.model_file import StatedModel
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ARM


def modelled_hole_issues(recipe: PegRecipe, key: str, model: StatedModel) -> Iterator[ConfigIssue]:
    """A part with the hole that the model has elsewhere, or not at all."""
    pose = recipe.base_T_hole.pose
    written = WrittenValue(f"{key}.base_T_hole.pose", str(list(pose)))
    yield from unmodelled_issues(model, recipe.device(ARM), written, pose_from_xyzabc(pose))
