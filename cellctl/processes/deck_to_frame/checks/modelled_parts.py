"""Holds the bodies of deck and frame in the model of a cell against the recipe.

Planning takes a way for free by the model alone. A part that is larger in the model than by the
recipe, or higher, costs ways that would be free; what the model lacks of a part is driven into
whatever stands there. So a body has to hold the part, and may be more than it.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.model_file import ModelBox, StatedModel
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.deck_to_frame.arms_in_roles import ArmsInRoles
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

_DECK, _FRAME = "deck", "frame"
"""Bodies whose names begin so are these parts; recipes with other parts have further bodies."""
_ROUNDING_MM = 1e-6


@dataclass(frozen=True, slots=True)
class _HeldPart:
    """Where a part lies, in a frame of which z is across its mating face; mm."""

    face_mm: tuple[float, float]
    low_mm: float
    high_mm: float
    tolerance_mm: float
    """A part that is measured farther beside its place ends the run before it is driven to."""

    def missed_by(self, part_T_box: RigidTransform, size_mm: Sequence[float]) -> str:
        """What of the part a body does not hold, in words; empty if it holds all."""
        half_mm = np.array(size_mm) / 2.0
        middle_mm = part_T_box.translation / MM
        corners_mm = [
            part_T_box.apply(np.array(signs) * half_mm * MM) / MM
            for signs in product((-1.0, 1.0), repeat=3)
        ]
        lowest_mm = min(float(corner[2]) for corner in corners_mm)
        highest_mm = max(float(corner[2]) for corner in corners_mm)
        # Half of a thin part may always be missed, or nothing would be left to be held.
        within_mm = self.tolerance_mm
        if self.high_mm > self.low_mm:
            within_mm = min(within_mm, (self.high_mm - self.low_mm) / 2.0)
        if highest_mm < self.high_mm - within_mm - _ROUNDING_MM:
            return f"ends {self.high_mm - highest_mm:.0f} mm below it"
        if lowest_mm > self.low_mm + within_mm + _ROUNDING_MM:
            return f"begins {lowest_mm - self.low_mm:.0f} mm above it"
        box_T_part = part_T_box.inv()
        for signs in product((-1.0, 1.0), repeat=2):
            x_mm, y_mm = (
                sign * max(0.0, side_mm / 2.0 - self.tolerance_mm)
                for sign, side_mm in zip(signs, self.face_mm, strict=True)
            )
            inside_mm = box_T_part.apply(np.array([x_mm, y_mm, middle_mm[2]]) * MM) / MM
            if np.any(np.abs(inside_mm) > half_mm + _ROUNDING_MM):
                return "does not hold its corners"
        return ""


def modelled_part_issues(
    cell: CellConfig, recipe: DeckRecipe, key: str, model: StatedModel
) -> Iterator[ConfigIssue]:
    """Bodies that do not hold the parts of a recipe; boxes alone, which need no mesh to be read."""
    main = ArmsInRoles(cell, recipe).main
    face = WrittenValue(f"{key}.face_mm", str(list(recipe.face_mm)))
    thick_mm, within_mm = recipe.deck_thickness_mm, recipe.station_tolerance_mm
    deck = _HeldPart(recipe.face_mm, -thick_mm, 0.0, within_mm)
    yield from _unheld(
        model,
        _named(model.at_flange.get(main, ()), _DECK),
        deck,
        pose_from_xyzabc(recipe.flange_T_deck),
        (
            face,
            WrittenValue(f"{key}.deck_thickness_mm", f"{thick_mm:g}"),
            WrittenValue(f"{key}.flange_T_deck", str(list(recipe.flange_T_deck))),
        ),
    )
    if main in model.bases:
        cell_T_frame = pose_from_xyzabc(model.bases[main]) * pose_from_xyzabc(recipe.base_T_frame)
        yield from _unheld(
            model,
            _named(model.fixtures, _FRAME),
            _HeldPart(recipe.face_mm, 0.0, 0.0, within_mm),
            cell_T_frame,
            (WrittenValue(f"{key}.base_T_frame", str(list(recipe.base_T_frame))), face),
        )


def _named(boxes: Iterable[ModelBox], name: str) -> list[ModelBox]:
    return [box for box in boxes if box.name.startswith(name)]


def _unheld(
    model: StatedModel,
    boxes: Sequence[ModelBox],
    part: _HeldPart,
    there_T_part: RigidTransform,
    against: tuple[WrittenValue, ...],
) -> Iterator[ConfigIssue]:
    """The first of the bodies of a part, where none of them holds it."""
    missed = [_missed(box, part, there_T_part) for box in boxes]
    if not missed or not all(missed):
        return
    box = boxes[0]
    turned = replace(box, size_mm=(box.size_mm[1], box.size_mm[0], box.size_mm[2]))
    meant = ""
    if not _missed(turned, part, there_T_part):
        meant = f"did you mean size_mm = {list(turned.size_mm)}? "
    allowed = (
        f"{meant}a body that holds the part of the recipe, give or take station_tolerance_mm = "
        f"{part.tolerance_mm:g}; this one {missed[0]}, and ways through what is missing would be "
        "called free"
    )
    value = f"size_mm {list(box.size_mm)} at {list(box.at)}"
    yield ConfigIssue(f"{model.file}: {box.key}", value, allowed, against=against)


def _missed(box: ModelBox, part: _HeldPart, there_T_part: RigidTransform) -> str:
    return part.missed_by(there_T_part.inv() * pose_from_xyzabc(box.at), box.size_mm)
