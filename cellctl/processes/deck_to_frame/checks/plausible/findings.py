"""Figures of a recipe, and poses of the cell, that are possible and in all likelihood slips."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import cast

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.checks.bounds.contradiction import contradictions
from cellctl.config.checks.places.sensor_places import sensor_bounds
from cellctl.config.issue import ConfigIssue
from cellctl.config.recipe import Recipe
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.checks.plausible.drawing import read_drawings
from cellctl.processes.deck_to_frame.checks.plausible.drawings import drawing_issues
from cellctl.processes.deck_to_frame.checks.plausible.face import face_issues
from cellctl.processes.deck_to_frame.checks.plausible.limits import limit_bounds
from cellctl.processes.deck_to_frame.checks.plausible.loads import load_issues
from cellctl.processes.deck_to_frame.checks.plausible.sigmas import sigma_bounds
from cellctl.processes.deck_to_frame.checks.plausible.station import station_issues
from cellctl.processes.deck_to_frame.checks.plausible.stored import stored_issues
from cellctl.processes.deck_to_frame.checks.plausible.zones import zone_use_issues
from cellctl.processes.deck_to_frame.checks.reach import height_bounds
from cellctl.processes.deck_to_frame.checks.turned_sensor import turned_sensor_issues
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import FORCE, MAIN
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.vision.features.feature_file import read_features

_MOST_OVER_TARGET = 5.0
"""Limit of force over target force. The guard stops in time to keep a limit of 1.4 times."""
_LEAST_STOP_MS = 20.0
"""A few cycles of a controller, before its brakes even begin."""
_THICKNESS_SIGMAS = 4.0
"""Standard deviations over the parts by which two statements of one thickness may differ: as many
as the contact window allows for. Beyond it the fast travel meets the frame."""
_LEAST_BOARD_MM = 50.0
"""A board of less fills a sixth of the picture of a small-field head, and calibrates its middle."""


def plausible_issues(
    cell: CellConfig, recipe: DeckRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Called with a recipe in which nothing else is wrong, so its feature files can be read."""
    settings = cast(DeckSettings, cell.processes[recipe.process])
    yield from _board(settings, f"processes.{recipe.process}")
    yield from _mating(recipe, key)
    yield from _thresholds(recipe, key)
    yield from _thickness(recipe, key, folder)
    yield from contradictions(cell, recipe, key, partial(_bounds, key=key))
    yield from face_issues(recipe, key, read_features(folder / recipe.deck_features))
    loads = list(load_issues(cell, recipe, key))
    yield from loads
    yield from station_issues(cell, recipe, key)
    yield from zone_use_issues(cell, recipe, settings)
    yield from turned_sensor_issues(cell, recipe, folder)
    named = {issue.key for issue in loads}
    yield from (one for one in stored_issues(cell, recipe, key, folder) if one.key not in named)
    deck, frame = read_drawings(recipe, key, folder)
    yield from drawing_issues(deck, frame, recipe)


def _bounds(cell: CellConfig, recipe: Recipe, key: str) -> Iterator[Bound]:
    known = cast(DeckRecipe, recipe)
    yield from limit_bounds(known, key)
    yield from sigma_bounds(known, key)
    yield from sensor_bounds(cell, known.device(FORCE), known.flange_T_deck)
    yield from height_bounds(cell, known.device(MAIN), known, key)


def _board(settings: DeckSettings, path: str) -> Iterator[ConfigIssue]:
    columns, rows = (int(side) for side in settings.board.split("x"))
    if columns == rows:
        # Turned by a quarter it shows the same picture, and every corner gets another's name.
        allowed = "columns and rows that differ: a square board looks the same turned by 90 deg"
        yield ConfigIssue(f"{path}.board", repr(settings.board), allowed)
    span_mm = (max(columns, rows) - 1) * settings.square_mm
    if span_mm < _LEAST_BOARD_MM:
        allowed = f"a board of {_LEAST_BOARD_MM:g} mm or more; its corners span {span_mm:g} mm"
        yield ConfigIssue(f"{path}.square_mm", f"{settings.square_mm:g}", allowed)


def _mating(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    mating = recipe.mating
    most_n = _MOST_OVER_TARGET * mating.target_force_n
    if mating.limit_force_n > most_n:
        allowed = f"at most {most_n:g}, {_MOST_OVER_TARGET:g} times target_force_n"
        yield ConfigIssue(f"{key}.mating.limit_force_n", f"{mating.limit_force_n:g}", allowed)
    if mating.stop_latency_ms < _LEAST_STOP_MS:
        # Speeds follow from it: a bound that no arm keeps makes the arm too fast to be stopped.
        allowed = f"at least {_LEAST_STOP_MS:g}: an upper bound, which no arm keeps below that"
        yield ConfigIssue(f"{key}.mating.stop_latency_ms", f"{mating.stop_latency_ms:g}", allowed)


def _thresholds(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    correction = recipe.pose_correction
    limits = {
        "threshold_mm": (correction.threshold_mm, recipe.seated_limit_mm, "seated_limit_mm"),
        "threshold_deg": (correction.threshold_deg, recipe.seated_limit_deg, "seated_limit_deg"),
    }
    if correction.threshold_about_x_deg or recipe.seated_limit_about_x_deg:
        about_x = correction.thresholds_deg[0], recipe.seated_limits_deg[0]
        limits["threshold_about_x_deg"] = (*about_x, "seated_limit_about_x_deg")
    if correction.threshold_about_z_deg:
        about_z = correction.threshold_about_z_deg, recipe.seated_limits_deg[2]
        limits["threshold_about_z_deg"] = (*about_z, "seated_limit_deg")
    for name, (threshold, most, limit) in limits.items():
        if threshold > most:
            # A deck within it would be mated, and then refused.
            allowed = f"at most {most:g}, which {limit} lets the seated deck have"
            yield ConfigIssue(f"{key}.pose_correction.{name}", f"{threshold:g}", allowed)
    if recipe.stand_off_mm < correction.max_correction_mm:
        # A deck that is off by the largest correction along the approach would touch the frame
        # before the first measurement could show it.
        allowed = f"at least {correction.max_correction_mm:g}, as pose_correction.max_correction_mm"
        yield ConfigIssue(f"{key}.stand_off_mm", f"{recipe.stand_off_mm:g}", allowed)


def _thickness(recipe: DeckRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """A deck thinner than its countersinks are deep, or not as thick as on its drawing.

    The heads see the upper face. How far below it the deck ends is what the recipe says, and a deck
    that is thicker than that meets its frame on the fast way to the stand-off.
    """
    features = read_features(folder / recipe.deck_features)
    for hole in features.holes:
        if hole.countersink_m is None:
            continue
        deep_mm = (hole.countersink_m - hole.diameter_m) / 2.0 / MM  # 90 degrees, as for ISO 10642
        if recipe.deck_thickness_mm <= deep_mm:
            allowed = f"more than {deep_mm:g}, the depth of countersink {hole.name}"
            yield ConfigIssue(f"{key}.deck_thickness_mm", f"{recipe.deck_thickness_mm:g}", allowed)
            return
    if features.thickness_m is None:
        return  # a remark says that there is nothing to compare with
    drawn_mm, sigma_mm = features.thickness_m / MM, recipe.deck_thickness_sigma_mm
    window_mm = recipe.mating.contact_window_mm
    most_mm = min(_THICKNESS_SIGMAS * sigma_mm, window_mm)
    # Both are decimals of a file: their difference is not exact.
    if abs(recipe.deck_thickness_mm - drawn_mm) > most_mm + 1e-6:
        allowed = (
            f"{drawn_mm:g}, give or take {most_mm:.3g}: thickness_mm of its features, and "
            f"{_THICKNESS_SIGMAS:g} times deck_thickness_sigma_mm = {sigma_mm:g}, at most "
            f"contact_window_mm = {window_mm:g}; a deck that is thicker by more meets its frame on "
            "the fast travel. Measure the decks, then write one thickness in both files"
        )
        yield ConfigIssue(f"{key}.deck_thickness_mm", f"{recipe.deck_thickness_mm:g}", allowed)
