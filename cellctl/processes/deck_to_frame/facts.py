"""Everything that is read and checked before a run; nothing has moved yet."""

import asyncio
from dataclasses import dataclass

from cellctl.calibration.files import StoredCalibration
from cellctl.cell.readiness import require_full_speed
from cellctl.force.gravity.payload_result import mass_kg
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import MEASURING
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.calibration_folder import PAYLOAD, CalibrationFolder, Calibrations
from cellctl.runtime.commissioned import Commissioned
from cellctl.runtime.job_factory import PLANNED
from cellctl.vision.features import FeatureFile, read_features


@dataclass(frozen=True, slots=True)
class RunFacts:
    """Recipe, calibrations and drawings of one run."""

    cell: DeckCell
    recipe: DeckRecipe
    calibrations: Calibrations
    stored: tuple[StoredCalibration, ...]
    """What production demands, as it lies on disk."""
    commissioned: Commissioned
    payload_kg: float
    """Everything that hangs on the force sensor, as identified."""
    frame_features: FeatureFile
    deck_features: FeatureFile


async def read_facts(cell: DeckCell, recipe: DeckRecipe, folder: CalibrationFolder) -> RunFacts:
    """Read and check everything; raises the faults of calibrations and feature files.

    Also ``SpeedOverridden``: better now than with the deck over its seat.
    """
    require_full_speed(cell.main)
    calibrations = await asyncio.to_thread(folder.read, PLANNED)
    frame = read_features(cell.cell.folder / recipe.frame_features)
    deck = read_features(cell.cell.folder / recipe.deck_features)
    for head in cell.heads:
        calibrations.require_instrument(head.name, await head.camera.serial_number())
        calibrations.require_head_pose(head.name, head.config.poses_deg[MEASURING])
    calibrations.require_instrument(PAYLOAD, cell.guard.health().sensor_serial)
    stored = await asyncio.to_thread(folder.stored)
    payload_kg = next(mass_kg(item.record) for item in stored if item.kind == PAYLOAD)
    commissioned = await asyncio.to_thread(folder.commissioned, recipe.id, PLANNED)
    return RunFacts(
        cell, recipe, calibrations, tuple(stored), commissioned, payload_kg, frame, deck
    )
