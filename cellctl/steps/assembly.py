"""A run in Production mode: one deck onto one frame, step by step (mission A)."""

import json
from datetime import timedelta
from hashlib import sha256

from cellctl import __version__, log
from cellctl.cell.archive import Archive
from cellctl.cell.calibrations import CalibrationFolder
from cellctl.cell.devices import Cell
from cellctl.cell.job import Job, SafePoint
from cellctl.cell.measuring import HeadGeometry, PartMeasurer
from cellctl.cell.progress import ProgressBoard
from cellctl.cell.step import Step
from cellctl.config.base import Section
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.plc.commands import LineCommand
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore
from cellctl.steps.compensate import compensate
from cellctl.steps.journal import Journal
from cellctl.steps.mate_deck import mate_deck
from cellctl.steps.measure_deck import measure_deck
from cellctl.steps.measure_frame import measure_frame
from cellctl.steps.positions import heads_to_measuring_poses, main_to_home
from cellctl.steps.pre_assembly import pre_assembly
from cellctl.steps.run import AssemblyRun, StepFunction
from cellctl.steps.verify import verify
from cellctl.vision.features import read_features

_log = log.get(__name__)

PLANNED = timedelta(minutes=30)
"""Calibrations must stay valid for this long after Start."""

STEPS: tuple[tuple[Step, StepFunction], ...] = (
    (Step.MEASURE_FRAME, measure_frame),
    (Step.MEASURE_DECK, measure_deck),
    (Step.PRE_ASSEMBLY, pre_assembly),
    (Step.COMPENSATE, compensate),
    (Step.MATE, mate_deck),
    (Step.VERIFY, verify),
)


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
        self._journal: Journal | None = None

    async def start(self) -> None:
        """Read and check everything, open the record, then bring the robots to the beginning."""
        self._calibrations = self._folder.read(PLANNED)
        self._frame_features = read_features(self._cell.folder / self._recipe.frame_features)
        self._deck_features = read_features(self._cell.folder / self._recipe.deck_features)
        for stored in self._folder.stored():
            await self._archive.do(RunStore.add_calibration, stored)
        self.run_number = await self._archive.do(
            RunStore.start_run,
            serial=self.serial,
            recipe_id=self._recipe.id,
            recipe_name=self._recipe.name,
            recipe_hash=content_hash(self._recipe),
            mode="production",
            software=f"cellctl {__version__}",
            config_hash=content_hash(self._cell.config),
            calibration_ids=self._calibrations.ids,
            simulated=self._cell.config.simulated,
            operator=self._command.order,
        )
        self._journal = Journal(self._archive, self._cell.workers, self.run_number)
        await self._cell.guard.set_compensation(self._calibrations.compensation)
        await main_to_home(self._cell)
        await heads_to_measuring_poses(self._cell)

    async def execute(self, safe_point: SafePoint) -> None:
        """All steps in their order."""
        assert self._journal is not None
        geometry = self._calibrations.geometry
        heads = HeadGeometry(*geometry.heads, geometry.c1_T_c2)
        run = AssemblyRun(
            cell=self._cell,
            recipe=self._recipe,
            calibrations=self._calibrations,
            frame_features=self._frame_features,
            deck_features=self._deck_features,
            board=self._board,
            journal=self._journal,
            safe_point=safe_point,
            measurer=PartMeasurer(self._cell, heads, self._recipe.compensation.method),
        )
        for step, function in STEPS:
            self._board.update(step=step, message="")
            with log.bound(run=self.run_number, step=step.label):
                _log.info("step begins")
                await function(run)

    async def close(self, outcome: RunResult, fault: CellError | None) -> None:
        """Close the run record; nothing to close when it was never opened."""
        self._board.update(step=Step.NONE)
        if self._journal is not None:
            await self._archive.do(
                RunStore.close_run,
                self.run_number,
                outcome,
                fault_number=fault.number if fault else None,
                fault=str(fault) if fault else None,
            )
            _log.info("run closed", result=outcome.value)


def content_hash(section: Section) -> str:
    """SHA-256 of a part of the cell file, independent of its layout."""
    text = json.dumps(section.model_dump(mode="json"), sort_keys=True)
    return sha256(text.encode()).hexdigest()
