"""A run in Production mode: one deck onto one frame, step by step (mission A)."""

import asyncio
import json
from datetime import timedelta
from hashlib import sha256

from cellctl import __version__, log
from cellctl.calibration.files import StoredCalibration
from cellctl.cell.archive import Archive
from cellctl.cell.calibrations import PAYLOAD, CalibrationFolder, Calibrations
from cellctl.cell.devices import Cell
from cellctl.cell.job import HeldMeanwhile, Job, SafePoint
from cellctl.cell.measuring import HeadGeometry, PartMeasurer
from cellctl.cell.progress import ProgressBoard
from cellctl.cell.step import Step
from cellctl.config.base import Section
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.vision import SeatedOffPosition
from cellctl.plc.commands import LineCommand
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore
from cellctl.steps.journal import Journal
from cellctl.steps.positions import heads_to_measuring_poses, main_to_home
from cellctl.steps.run import AssemblyRun
from cellctl.steps.sequence import Sequence
from cellctl.vision.features import FeatureFile, read_features

_log = log.get(__name__)

PLANNED = timedelta(minutes=30)
"""Calibrations must stay valid for this long after Start."""


class Assembly(Job):
    """Opens the record before anything moves and closes it whatever happens."""

    def __init__(
        self,
        cell: Cell,
        archive: Archive,
        board: ProgressBoard,
        calibrations: CalibrationFolder,
        *,
        recipe: Recipe,
        command: LineCommand,
    ) -> None:
        self.number = recipe.id
        self.serial = command.serial
        self._cell = cell
        self._archive = archive
        self._board = board
        self._folder = calibrations
        self._recipe = recipe
        self._command = command
        self._opening: asyncio.Task[int] | None = None
        self._journal: Journal | None = None

    @property
    def outcome(self) -> RunResult:
        """A dry run ends without a part: never good."""
        return RunResult.BAD if self._command.dry_run else RunResult.GOOD

    async def start(self) -> None:
        """Read and check everything, open the record, then bring the robots to the beginning.

        Raises the faults of calibrations, feature files, records and robots.
        """
        cell, folder = self._cell, self._cell.folder
        self._calibrations = await asyncio.to_thread(self._folder.read, PLANNED)
        self._frame_features = read_features(folder / self._recipe.frame_features)
        self._deck_features = read_features(folder / self._recipe.deck_features)
        await self._check_instruments(self._calibrations)
        stored = await asyncio.to_thread(self._folder.stored)
        self._opening = asyncio.create_task(self._open(stored, self._calibrations))
        self.run_number = await asyncio.shield(self._opening)
        self._journal = Journal(self._archive, cell.workers, self.run_number)
        await cell.guard.set_compensation(self._calibrations.compensation)
        await self._to_the_beginning()

    async def execute(self, safe_point: SafePoint) -> None:
        """All steps in their order; from the beginning again when the cell was held on the way."""
        assert self._journal is not None
        sequence = Sequence(
            single_step=self._command.single_step, until_mating=self._command.dry_run
        )
        while True:
            run = self._run(self._journal, safe_point)
            try:
                await sequence.run(run, self.run_number)
            except HeldMeanwhile:
                _log.info("held meanwhile: everything is measured again")
                await self._to_the_beginning()
            else:
                return

    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        """Close the run record; nothing to close when it could not be opened."""
        self._board.update(step=Step.NONE)
        if isinstance(fault, SeatedOffPosition):
            outcome = RunResult.BAD
        if self._opening is None:
            return outcome
        try:
            self.run_number = await self._opening
        except CellError:
            return outcome  # there is no record; this is the fault that has ended the run
        await self._archive.do(
            RunStore.close_run,
            self.run_number,
            outcome,
            fault_number=fault.number if fault else None,
            fault=str(fault) if fault else None,
        )
        _log.info("run closed", result=outcome.value)
        return outcome

    async def _open(self, stored: list[StoredCalibration], used: Calibrations) -> int:
        """Open the record. A task of its own: a Stop must not leave a row that nobody closes."""
        for calibration in stored:
            await self._archive.do(RunStore.add_calibration, calibration)
        return await self._archive.do(
            RunStore.start_run,
            serial=self.serial,
            recipe_id=self._recipe.id,
            recipe_name=self._recipe.name,
            recipe_hash=content_hash(self._recipe),
            mode="dry run" if self._command.dry_run else "production",
            software=f"cellctl {__version__}",
            config_hash=content_hash(self._cell.config),
            calibration_ids=used.ids,
            simulated=self._cell.config.simulated,
            operator=self._command.order,
        )

    async def _check_instruments(self, calibrations: Calibrations) -> None:
        for head in self._cell.heads:
            calibrations.require_instrument(head.name, await head.camera.serial_number())
        calibrations.require_instrument(PAYLOAD, self._cell.guard.health().sensor_serial)

    async def _to_the_beginning(self) -> None:
        self._board.update(step=Step.NONE, iteration=0, message="to the beginning")
        await main_to_home(self._cell)
        await heads_to_measuring_poses(self._cell)

    def _run(self, journal: Journal, safe_point: SafePoint) -> AssemblyRun:
        """Nothing measured yet. Heads count as unmoved from here on."""
        geometry = self._calibrations.geometry
        heads = HeadGeometry(*geometry.heads, geometry.c1_T_c2)
        features: tuple[FeatureFile, FeatureFile] = self._frame_features, self._deck_features
        return AssemblyRun(
            cell=self._cell,
            recipe=self._recipe,
            calibrations=self._calibrations,
            frame_features=features[0],
            deck_features=features[1],
            board=self._board,
            journal=journal,
            pause=safe_point,
            measurer=PartMeasurer(self._cell, heads, self._recipe.compensation.method),
        )


def content_hash(section: Section) -> str:
    """SHA-256 of a part of the cell file, independent of its layout."""
    text = json.dumps(section.model_dump(mode="json"), sort_keys=True)
    return sha256(text.encode()).hexdigest()
