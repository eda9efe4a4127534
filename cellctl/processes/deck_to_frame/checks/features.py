"""Checks that a part can be measured with the feature files that a recipe names."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cellctl.config.issue import ConfigIssue
from cellctl.errors.vision import FeatureFileInvalid
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile, read_features
from cellctl.vision.registration.rigid_fit import on_a_line


def feature_issues(recipe: DeckRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """Every feature file that cannot be read, or from which no pose would follow."""
    for name in ("frame_features", "deck_features"):
        file = getattr(recipe, name)
        fault = _fault(folder / file)
        if fault:
            yield ConfigIssue(f"{key}.{name}", repr(file), fault, FeatureFileInvalid.number)


def _fault(path: Path) -> str:
    try:
        features = read_features(path)
    except FeatureFileInvalid as error:
        return error.detail
    return _unmeasurable(features)


def _unmeasurable(features: FeatureFile) -> str:
    for key, names in (("head_1", features.head_1), ("head_2", features.head_2)):
        if not names:
            return f"{key} must list the holes that this head sees"
    # Together, because the pose is fitted to the holes of both heads.
    seen = {hole.name: hole for head in (1, 2) for hole in features.seen_by(head)}
    if on_a_line(np.array([hole.position_m for hole in seen.values()])):
        return "head_1 and head_2 together need three holes that are not on a line"
    return ""
