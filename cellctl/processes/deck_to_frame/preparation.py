"""What every run over the station begins with: read and check, go to the beginning."""

import asyncio
from dataclasses import dataclass
from datetime import timedelta

from cellctl import log
from cellctl.calibration.files import StoredCalibration
from cellctl.cell.devices import Cell
from cellctl.cell.readiness import require_full_speed
from cellctl.force.payload_result import mass_kg
from cellctl.processes.deck_to_frame.journal import Journal
from cellctl.processes.deck_to_frame.measuring import HeadGeometry, PartMeasurer
from cellctl.processes.deck_to_frame.recipe import Recipe
from cellctl.processes.deck_to_frame.run import AssemblyRun
from cellctl.processes.deck_to_frame.sequence import Sequence
from cellctl.processes.deck_to_frame.taught_poses import heads_to_measuring_poses, main_to_home
from cellctl.runtime.calibration_folder import PAYLOAD, CalibrationFolder, Calibrations
from cellctl.runtime.commissioned import Commissioned
from cellctl.runtime.job import HeldMeanwhile, SafePoint
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.step import Step
from cellctl.vision.features import FeatureFile, read_features

_log = log.get(__name__)

PLANNED = timedelta(minutes=30)
"""Calibrations must stay valid for this long after Start."""


@dataclass(frozen=True, slots=True)
class Preparation:
    """Everything that is read before a run."""

    recipe: Recipe
    calibrations: Calibrations
    stored: list[StoredCalibration]
    commissioned: Commissioned
    payload_kg: float
    """Everything that hangs on the force sensor, as identified."""
    frame_features: FeatureFile
    deck_features: FeatureFile

    @property
    def ids(self) -> dict[str, str]:
        """Identity of every record that counts in the run, by kind."""
        return {**self.calibrations.ids, **self.commissioned.ids}


async def prepare(cell: Cell, folder: CalibrationFolder, recipe: Recipe) -> Preparation:
    """Read and check everything; raises the faults of calibrations and feature files.

    Also ``SpeedOverridden``: better now than with the deck over its seat.
    """
    require_full_speed(cell.main)
    calibrations = await asyncio.to_thread(folder.read, PLANNED)
    frame = read_features(cell.folder / recipe.frame_features)
    deck = read_features(cell.folder / recipe.deck_features)
    for head in cell.heads:
        calibrations.require_instrument(head.name, await head.camera.serial_number())
        calibrations.require_head_pose(head.name, head.config.measuring_joints_deg)
    calibrations.require_instrument(PAYLOAD, cell.guard.health().sensor_serial)
    stored = await asyncio.to_thread(folder.stored)
    payload_kg = next(mass_kg(item.record) for item in stored if item.kind == PAYLOAD)
    commissioned = await asyncio.to_thread(folder.commissioned, recipe.id, PLANNED)
    stored += commissioned.records
    return Preparation(recipe, calibrations, stored, commissioned, payload_kg, frame, deck)


async def to_the_beginning(cell: Cell, board: ProgressBoard) -> None:
    """The deck clear of the station, the heads over it."""
    board.update(step=Step.NONE, iteration=0, message="to the beginning")
    await main_to_home(cell)
    await heads_to_measuring_poses(cell)


async def repeat_until_unheld(
    sequence: Sequence,
    *,
    cell: Cell,
    prepared: Preparation,
    board: ProgressBoard,
    journal: Journal,
    pause: SafePoint,
) -> None:
    """All steps in their order; from the beginning again when the cell was held on the way."""
    while True:
        run = _new_run(cell, prepared, board, journal, pause)
        try:
            await sequence.run(run, journal.run)
        except HeldMeanwhile:
            _log.info("held meanwhile: everything is measured again")
            await to_the_beginning(cell, board)
        else:
            return


def _new_run(
    cell: Cell,
    prepared: Preparation,
    board: ProgressBoard,
    journal: Journal,
    pause: SafePoint,
) -> AssemblyRun:
    """Nothing measured yet. Heads count as unmoved from here on."""
    geometry = prepared.calibrations.geometry
    heads = HeadGeometry(*geometry.heads, geometry.c1_T_c2)
    return AssemblyRun(
        cell=cell,
        recipe=prepared.recipe,
        calibrations=prepared.calibrations,
        commissioned=prepared.commissioned,
        payload_kg=prepared.payload_kg,
        frame_features=prepared.frame_features,
        deck_features=prepared.deck_features,
        board=board,
        journal=journal,
        pause=pause,
        measurer=PartMeasurer(cell, heads, prepared.recipe.compensation.method),
    )
