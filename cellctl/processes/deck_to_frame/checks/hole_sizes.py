"""Holds the sizes by which an exposure is found against the drawn holes as a head sees them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.cameras import LEAST_HOLE_PX
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.checks.plausible.drawing import PartDrawing
from cellctl.processes.deck_to_frame.checks.plausible.sight import (
    calibrated_camera,
    parts_under_heads,
)
from cellctl.processes.deck_to_frame.checks.plausible.stored import stored_record
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2


def hole_size_remarks(
    cell: CellConfig, recipe: DeckRecipe, drawings: tuple[PartDrawing, PartDrawing], folder: Path
) -> Iterator[ConfigIssue]:
    """``hole_px`` within which no hole of the head lies; where its calibrations are stored.

    ``drawings`` of deck and frame.
    """
    for role in (HEAD_1, HEAD_2):
        head = recipe.device(role)
        wanted = cell.stereo_cameras[head].auto_exposure
        if wanted is None or wanted.hole_px[1] < LEAST_HOLE_PX:
            continue  # so small a one is remarked on whatever is drawn
        radii_px = _radii_px(cell, recipe, drawings, folder, role)
        least_px, most_px = wanted.hole_px
        if radii_px and not any(least_px <= radius_px <= most_px for radius_px in radii_px):
            said = (
                f"the drawn holes have radii of {min(radii_px):.0f} to {max(radii_px):.0f} px in "
                "its picture, by the stored calibrations: with others no exposure is found"
            )
            where = f"stereo_cameras.{head}.auto_exposure.hole_px"
            yield ConfigIssue(where, str(list(wanted.hole_px)), said)


def _radii_px(
    cell: CellConfig,
    recipe: DeckRecipe,
    drawings: tuple[PartDrawing, PartDrawing],
    folder: Path,
    role: str,
) -> list[float]:
    """Of the holes that the left camera of a head is to see; empty where it is not calibrated."""
    record = stored_record(cell, folder, role)
    base_T_camera = calibrated_camera(cell, recipe, folder, role)
    if record is None or base_T_camera is None:
        return []
    focal_px = float(np.array(record["left"]["camera_matrix"])[0, 0])
    found = []
    for part in parts_under_heads(cell, recipe, *drawings):
        camera_T_part = base_T_camera.inv() * part.base_T_part
        for name in part.holes_of(role):
            away_m = float(camera_T_part.apply(part.drawing.position_mm(name) * MM)[2])
            found.append(focal_px * part.drawing.holes[name].diameter_m / 2.0 / away_m)
    return found
