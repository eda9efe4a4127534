"""Reads and checks everything that a run needs before anything moves."""

import asyncio
from dataclasses import dataclass

from cellctl.calibration.payload import IdentifiedPayload
from cellctl.calibration.store.kind import Kinds
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.readiness import require_full_speed
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import PAYLOAD
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import FORCE, HEAD_1, HEAD_2, MEASURING
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.jobs.factory import PLANNED
from cellctl.vision.features.feature_file import FeatureFile, read_features


@dataclass(frozen=True, slots=True)
class RunFacts:
    """Recipe, calibrations and drawings of one run."""

    cell: DeckCell
    recipe: DeckRecipe
    calibrations: CalibrationSnapshot
    """Everything that counts in the run, as it lies on disk."""
    geometry: CalibrationSet
    payload: IdentifiedPayload
    commissioned: Commissioned
    frame_features: FeatureFile
    deck_features: FeatureFile


async def read_facts(
    cell: DeckCell, recipe: DeckRecipe, store: CalibrationStore, kinds: Kinds
) -> RunFacts:
    """Read and check everything; ``kinds`` are the calibrations that count in the run.

    Raises the faults of calibrations and feature files, and ``SpeedOverridden``: better now than
    with the deck over its seat.
    """
    # Stop latency and approach speed are planned for full speed; with an override nothing that is
    # planned on times would hold.
    require_full_speed(cell.main)
    kinds = [kind.for_recipe(recipe.id) for kind in kinds]
    # Looked at ahead of time, so that no calibration expires in the middle of the run.
    snapshot = await asyncio.to_thread(store.read_all, kinds, utc_now() + PLANNED)
    frame = read_features(cell.cell.folder / recipe.frame_features)
    deck = read_features(cell.cell.folder / recipe.deck_features)
    await _require_same_cell(cell, snapshot, kinds)
    return RunFacts(
        cell=cell,
        recipe=recipe,
        calibrations=snapshot,
        geometry=CalibrationSet.of(snapshot),
        payload=snapshot.get(PAYLOAD),
        commissioned=Commissioned.of(snapshot, recipe.id),
        frame_features=frame,
        deck_features=deck,
    )


async def _require_same_cell(cell: DeckCell, snapshot: CalibrationSnapshot, kinds: Kinds) -> None:
    """Raise when a device was exchanged, or a head taught another pose, since a calibration."""
    # Asked of the devices and not of the cell file: an exchanged head answers with its own number
    # whatever the file says.
    serial_numbers = {
        HEAD_1: await cell.head_1.camera.serial_number(),
        HEAD_2: await cell.head_2.camera.serial_number(),
        FORCE: cell.guard.health().sensor_serial,
    }
    for kind in kinds:
        if kind.device is not None:
            snapshot.require_instrument(kind, serial_numbers[kind.device])
        if kind.holds_for is not None:
            for role in (HEAD_1, HEAD_2):
                taught = cell.head(role).config.poses_deg[MEASURING]
                snapshot.require_taught_pose(kind, role, taught)
