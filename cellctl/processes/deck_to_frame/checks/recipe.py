"""Finds what is wrong with a recipe beyond its own keys; touches no hardware."""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import first_link_mm
from cellctl.config.issue import ConfigIssue
from cellctl.processes.deck_to_frame.checks.base_frame_turns import base_frame_turn_issues
from cellctl.processes.deck_to_frame.checks.features import feature_issues
from cellctl.processes.deck_to_frame.checks.mating_plan import plan_issues
from cellctl.processes.deck_to_frame.checks.parts import part_issues
from cellctl.processes.deck_to_frame.checks.reach import reach_issues
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import FORCE, HEAD_1, HEAD_2, MAIN
from cellctl.processes.deck_to_frame.settings import DeckSettings


def recipe_issues(
    cell: CellConfig, recipe: DeckRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Devices that do not belong together, joint targets, feature files, and the mating's plan."""
    sensor, main = recipe.device(FORCE), recipe.device(MAIN)
    mounted_on = cell.force_sensors[sensor].mounted_on
    if mounted_on != main:
        where = f"force_sensors.{sensor}.mounted_on"
        yield ConfigIssue(where, repr(mounted_on), f"the robot that carries the deck: {main}")
    for name, length_mm in zip(("d1_mm", "a1_mm"), first_link_mm(cell.robots[main]), strict=True):
        if length_mm is None:
            allowed = "needed, or a dh table: procedure 103 calibrates the base frame with it"
            yield ConfigIssue(f"robots.{main}.{name}", "(missing)", allowed)
    settings = cast(DeckSettings, cell.processes[recipe.process])
    yield from base_frame_turn_issues(cell, main, settings, recipe.process)
    yield from _heads(cell, recipe)
    yield from reach_issues(cell, main, recipe, key)
    yield from feature_issues(recipe, key, folder)
    yield from part_issues(recipe, key, folder)
    yield from plan_issues(cell, recipe, key)


def _heads(cell: CellConfig, recipe: DeckRecipe) -> Iterator[ConfigIssue]:
    """Each head has an arm of its own: both measure at once, while the deck hangs on the third."""
    taken = {recipe.device(MAIN): "the deck"}
    for role in (HEAD_1, HEAD_2):
        head = recipe.device(role)
        carrier = cell.stereo_cameras[head].carried_by
        if carrier in taken:
            allowed = f"another robot; this one carries {taken[carrier]}"
            yield ConfigIssue(f"stereo_cameras.{head}.carried_by", repr(carrier), allowed)
        elif carrier is not None:
            taken[carrier] = head
