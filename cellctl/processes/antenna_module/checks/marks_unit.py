"""Drawings of marks whose places are in metres or inches."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.drawings import read_drawings, read_plate
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.settings import ReferenceSection

_LEAST_MM = 5.0
"""Marks that are spread less tell no turn: 5 µm on 5 mm are 0.06°, three times what a plug may
have."""


def marks_unit_issues(
    recipe: AntennaRecipe, key: str, reference: ReferenceSection | None, where: str, folder: Path
) -> Iterator[ConfigIssue]:
    """``where`` is the key of the settings of the process."""
    drawings = read_drawings(recipe, folder)
    drawn: dict[str, tuple[str, Marks]] = {
        f"{key}.gripper_marks": (recipe.gripper_marks, drawings.gripper),
        f"{key}.module_top": (recipe.module_top, drawings.top),
    }
    if reference is not None:
        plate = read_plate(reference, folder)
        drawn[f"{where}.reference.plate_above"] = (reference.plate_above, plate.above)
        drawn[f"{where}.reference.plate_below"] = (reference.plate_below, plate.below)
    for at, (file, marks) in drawn.items():
        spread_mm = float(np.ptp(marks.positions_m, axis=0).max()) / MM
        if spread_mm < _LEAST_MM:
            allowed = (
                f"marks that are spread over {_LEAST_MM:g} mm or more, or they tell no turn; these "
                f"lie within {spread_mm:.2g} mm: were they written in metres or inches?"
            )
            yield ConfigIssue(at, repr(file), allowed)
