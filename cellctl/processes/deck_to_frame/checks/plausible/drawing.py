"""A feature file with the lines in which its figures stand, for findings."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cellctl.config.document.lines import key_lines
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.files.hand_written import hand_written
from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile, parse_features
from cellctl.vision.features.hole import Hole


@dataclass(frozen=True, slots=True, eq=False)
class PartDrawing:
    """The holes of one part, as a recipe names their file."""

    part: str
    """``deck`` or ``frame``."""
    written: str
    """The file, as the recipe has it."""
    recipe_key: str
    features: FeatureFile
    lines: dict[str, int]

    @property
    def holes(self) -> dict[str, Hole]:
        """The holes of the drawing by their names."""
        return {hole.name: hole for hole in self.features.holes}

    def position_mm(self, name: str) -> Array:
        """Position of a hole on the drawing, shape (3,)."""
        return np.asarray(self.holes[name].position_m) / MM

    def issue(self, key: str, value: str, allowed: str) -> ConfigIssue:
        """A finding at a key of the file."""
        line = self.lines.get(key)
        place = f"line {line}: " if line else ""
        return ConfigIssue(
            self.recipe_key, repr(self.written), f"{place}{key} = {value}: {allowed}"
        )

    def hole_issue(
        self,
        name: str,
        key: str,
        value: str,
        allowed: str,
        against: tuple[WrittenValue, ...] = (),
    ) -> ConfigIssue:
        """A finding at a key of a hole, and the values of the cell file that it contradicts."""
        index = list(self.holes).index(name)
        line = self.lines.get(f"hole.{index}.{key}", self.lines.get(f"hole.{index}"))
        place = f"line {line}: " if line else ""
        text = f"{place}hole {name}, {key} = {value}: {allowed}"
        return ConfigIssue(self.recipe_key, repr(self.written), text, against=against)


def read_drawings(recipe: DeckRecipe, key: str, folder: Path) -> tuple[PartDrawing, PartDrawing]:
    """Deck and frame; raises ``FeatureFileInvalid``."""
    deck, frame = (
        _drawing(part, written, f"{key}.{part}_features", folder)
        for part, written in (("deck", recipe.deck_features), ("frame", recipe.frame_features))
    )
    return deck, frame


def _drawing(part: str, written: str, recipe_key: str, folder: Path) -> PartDrawing:
    path = folder / written
    content = path.read_bytes()
    return PartDrawing(
        part,
        written,
        recipe_key,
        parse_features(content, str(path)),
        key_lines(hand_written(content)),
    )
