"""Checks that the two feature files of a recipe describe its deck and its frame."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cellctl.config.issue import ConfigIssue
from cellctl.errors.vision import FeatureFileInvalid
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile, read_features

_SAME_PLACE_M = 0.5 * MM
"""Holes of deck and frame that are farther apart than this do not lie over each other."""
_EDGE_M = 1.0 * MM
"""Drawings give the face without its chamfer."""


def part_issues(recipe: DeckRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """Exchanged files, holes beside the face, and holes of one name that do not meet."""
    try:
        deck = read_features(folder / recipe.deck_features)
        frame = read_features(folder / recipe.frame_features)
    except FeatureFileInvalid:
        return  # reported by itself
    written = repr(recipe.deck_features)
    if _is_frame(deck):
        allowed = "holes of the deck; this file has threads and no countersinks, as a frame has"
        yield ConfigIssue(f"{key}.deck_features", written, allowed)
    elif _is_deck(frame):
        allowed = "holes of the frame; this file has countersinks and no threads, as a deck has"
        yield ConfigIssue(f"{key}.frame_features", repr(recipe.frame_features), allowed)
    elif apart := _apart(deck, frame):
        allowed = f"hole {apart} lies elsewhere in x, y than in {recipe.frame_features}"
        yield ConfigIssue(f"{key}.deck_features", written, allowed)
    if beside := _beside(deck, recipe):
        allowed = f"a face that holds every hole of {recipe.deck_features}; {beside} lies beside it"
        yield ConfigIssue(f"{key}.face_mm", str(list(recipe.face_mm)), allowed)


def _is_frame(features: FeatureFile) -> bool:
    kinds = {hole.kind for hole in features.holes}
    return "thread" in kinds and "countersink" not in kinds


def _is_deck(features: FeatureFile) -> bool:
    kinds = {hole.kind for hole in features.holes}
    return "countersink" in kinds and "thread" not in kinds


def _apart(deck: FeatureFile, frame: FeatureFile) -> str:
    """The first hole that both files have at different places; seated, both are in line."""
    places = {hole.name: hole.position_m for hole in frame.holes}
    for hole in deck.holes:
        if hole.name in places:
            off_m = np.subtract(hole.position_m, places[hole.name])[:2]
            if np.linalg.norm(off_m) > _SAME_PLACE_M:
                return hole.name
    return ""


def _beside(deck: FeatureFile, recipe: DeckRecipe) -> str:
    half_m = np.array(recipe.face_mm) * MM / 2.0 + _EDGE_M
    for hole in deck.holes:
        if np.any(np.abs(np.asarray(hole.position_m)[:2]) > half_m):
            return hole.name
    return ""
