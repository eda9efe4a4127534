"""Places of an antenna recipe that the arm cannot come to, and figures that no arm has."""

from collections.abc import Iterator, Mapping
from functools import partial
from math import degrees, dist
from pathlib import Path
from typing import Any, cast

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.checks.bounds.contradiction import contradictions
from cellctl.config.checks.places.flange_places import flange_place_issues
from cellctl.config.checks.places.sensor_places import sensor_bounds
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.recipe import Recipe
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.checks.above import above_issues
from cellctl.processes.antenna_module.checks.drawn import (
    contact_bounds,
    force_issues,
    holding_bounds,
    one_file_twice,
    pull_issues,
    spread_issues,
)
from cellctl.processes.antenna_module.checks.figures import (
    arm_bounds,
    board_bounds,
    gap_bounds,
    stored_cameras,
)
from cellctl.processes.antenna_module.checks.looks import OVER, look_issues
from cellctl.processes.antenna_module.checks.marks_unit import marks_unit_issues
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.drawings import read_drawings
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM, FORCE
from cellctl.processes.antenna_module.settings import AntennaSettings

_MARKS_DEG = 45.0
"""Half of the turn by which a drawing is laid out otherwise."""
_MARKS_MM = 100.0
"""Marks and plug lie in one picture of camera II, within its depth of field."""


def plausible_issues(
    cell: CellConfig, recipe: AntennaRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Called with a recipe in which nothing else is wrong."""
    settings = _settings(cell, recipe)
    where = f"processes.{recipe.process}"
    yield from one_file_twice(recipe, key, settings.reference, where)
    yield from marks_unit_issues(recipe, key, settings.reference, where, folder)
    yield from force_issues(cell, recipe, key, folder)
    yield from spread_issues(recipe, key, folder)
    yield from pull_issues(cell, recipe, key)
    # Read once: no other value of a figure, of which hundreds are tried, names other files.
    socket, stored = read_drawings(recipe, folder).socket, stored_cameras(cell, folder)
    bounds = partial(_bounds, key=key, socket=socket, stored=stored)
    yield from contradictions(cell, recipe, key, bounds)
    yield from _marks(recipe, key)
    places = list(_places(cell, recipe, key))
    yield from places
    if not places:
        yield from above_issues(cell, recipe, key)
        yield from look_issues(cell, recipe, key)


def _bounds(
    cell: CellConfig,
    recipe: Recipe,
    key: str,
    socket: Connector,
    stored: Mapping[str, Mapping[str, Any]],
) -> Iterator[Bound]:
    known, settings = cast(AntennaRecipe, recipe), _settings(cell, recipe)
    where = f"processes.{recipe.process}"
    yield from contact_bounds(known, key, socket)
    yield from holding_bounds(known, key, socket)
    yield from arm_bounds(cell, known.device(ARM), settings, where)
    yield from sensor_bounds(cell, known.device(FORCE), known.flange_T_plug)
    yield from board_bounds(settings, where, stored)
    yield from gap_bounds(known, settings, key)


def _settings(cell: CellConfig, recipe: Recipe) -> AntennaSettings:
    return cast(AntennaSettings, cell.processes[recipe.process])


def _marks(recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Marks of the gripper that no picture of the plug would show."""
    marks, plug = recipe.flange_T_marks, recipe.flange_T_plug
    away_mm = dist(marks[:3], plug[:3])
    if away_mm > _MARKS_MM:
        allowed = (
            f"within {_MARKS_MM:g} mm of the plug, with which the marks lie in one picture; this "
            f"is {away_mm:.0f} mm away"
        )
        against = (WrittenValue(f"{key}.flange_T_plug", str(list(plug))),)
        yield ConfigIssue(f"{key}.flange_T_marks", str(list(marks)), allowed, against=against)


def marks_remarks(recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Marks of the gripper that are turned against the plug between them."""
    plug_T_marks = pose_from_xyzabc(recipe.flange_T_plug).inv() * pose_from_xyzabc(
        recipe.flange_T_marks
    )
    turned_deg = degrees(plug_T_marks.rotation.magnitude())
    if turned_deg > _MARKS_DEG:
        said = (
            f"turned by {turned_deg:.0f} deg against the plug, whose drawing and that of the marks "
            "lie in one picture of camera II; right if the marks are drawn from the other side"
        )
        yield ConfigIssue(f"{key}.flange_T_marks", str(list(recipe.flange_T_marks)), said)


def _places(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Tray and socket against the box of the flange."""
    plug_T_flange = pose_from_xyzabc(recipe.flange_T_plug).inv()
    plug = WrittenValue(f"{key}.flange_T_plug", str(list(recipe.flange_T_plug)))
    places = {
        "base_T_tray_plug": ("when it picks", recipe.base_T_tray_plug.pose, None),
        "base_T_socket": ("with the plug in the socket", recipe.base_T_socket.pose, OVER),
    }
    for name, (what, written, turn) in places.items():
        base_T_plug = pose_from_xyzabc(written)
        if turn is not None:
            base_T_plug = base_T_plug * turn
        yield from flange_place_issues(
            cell,
            recipe.device(ARM),
            (WrittenValue(f"{key}.{name}.pose", str(list(written))), plug),
            {what: base_T_plug * plug_T_flange},
        )
