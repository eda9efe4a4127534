"""The process: an antenna module is taken from its tray and plugged (paper, section 2)."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import StatedModel
from cellctl.config.recipe import Recipe, first_of_each
from cellctl.config.stated.moves import StatedMove
from cellctl.processes.antenna_module.faults.connector import ContactBent, ContactMissing
from cellctl.processes.antenna_module.faults.plugging import (
    FORCE_FAULTS,
    GrippedOffTwice,
    ModuleInGripper,
    MovedOnRelease,
)
from cellctl.processes.antenna_module.last_check import LastCheck
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM, CAMERA_1, CAMERA_2, FORCE, ROLES
from cellctl.processes.antenna_module.settings import AntennaSettings
from cellctl.records.entries import RunRecord
from cellctl.records.report.sections import ProcessPages, ReadArtefact
from cellctl.runtime.process import CellServices, Prepared, Process, RunContext
from cellctl.runtime.steps import Steps

if TYPE_CHECKING:
    from cellctl.calibration.store.kind import Kinds
    from cellctl.processes.antenna_module.facts import PluggingFacts
    from cellctl.processes.antenna_module.run import PluggingRun
    from cellctl.processes.antenna_module.state import GripperEmpty
    from cellctl.processes.antenna_module.stations import AntennaCell
    from cellctl.records.required.required_figures import RequiredFigure
    from cellctl.runtime.procedure import Procedure, ProcedureReplay

# What computes is imported where it is used: whoever only reads a cell file loads this module too,
# and an operator's command must not wait for vision and force.


class AntennaModule(Process["PluggingFacts", "PluggingRun", "GripperEmpty"]):
    """System B: find, pick, look from below, look at the socket, plug, verify."""

    name = "antenna-module"
    no_replay = (
        "does not have the planes in which its images were measured, and a taught plug no images"
    )
    recipe_model = AntennaRecipe
    settings_model = AntennaSettings
    roles = ROLES
    stores = (
        CAMERA_1,
        CAMERA_2,
        "flange_T_cam1",
        "base_T_cam2",
        "reference",
        "plug_correction",
        "tool_turn",
        "tool",
    )
    # Of the plug alone: what is wrong with a socket is told as SocketUnsound.
    spoiled_by = FORCE_FAULTS | {MovedOnRelease, GrippedOffTwice, ContactMissing, ContactBent}

    def __init__(self, services: CellServices) -> None:
        super().__init__(services)
        self._last_check = LastCheck()

    @classmethod
    def check(
        cls, cell: CellConfig, recipe: Recipe, key: str, folder: Path
    ) -> Iterable[ConfigIssue]:
        """Drawings, and devices that must be on the same arm."""
        from cellctl.processes.antenna_module.checks.recipe import recipe_issues

        return recipe_issues(cell, cast(AntennaRecipe, recipe), key, folder)

    @classmethod
    def check_plausible(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        key: str,
        folder: Path,
    ) -> Iterable[ConfigIssue]:
        """Figures and poses that fit their own keys and not each other."""
        from cellctl.processes.antenna_module.checks.plausible import plausible_issues

        return plausible_issues(cell, cast(AntennaRecipe, recipe), key, folder)

    @classmethod
    def check_model(
        cls, cell: CellConfig, recipe: Recipe, key: str, model: StatedModel
    ) -> Iterable[ConfigIssue]:
        """Whether bodies have tray, socket and reference plate."""
        from cellctl.processes.antenna_module.checks.modelled_stations import (
            modelled_station_issues,
        )

        return modelled_station_issues(cell, cast(AntennaRecipe, recipe), key, model)

    @classmethod
    def remarks(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        key: str,
        folder: Path,
    ) -> Iterable[ConfigIssue]:
        """Another board than that of the stored cameras, and looks beside what was measured."""
        from cellctl.config.checks.arms.tool_floor import tool_floor_remarks
        from cellctl.processes.antenna_module.checks.above import above_remarks
        from cellctl.processes.antenna_module.checks.drawn import (
            capture_remarks,
            holding_remarks,
            outline_remarks,
            pitch_remarks,
        )
        from cellctl.processes.antenna_module.checks.figures import board_remarks
        from cellctl.processes.antenna_module.checks.looks import look_remarks
        from cellctl.processes.antenna_module.checks.plate_sides import plate_side_remarks
        from cellctl.processes.antenna_module.checks.plausible import marks_remarks
        from cellctl.processes.antenna_module.checks.taught_drawings import taught_drawing_remarks
        from cellctl.processes.antenna_module.checks.uncalibrated import uncalibrated_remarks

        settings = cast(AntennaSettings, cell.processes[recipe.process])
        plugged = cast(AntennaRecipe, recipe)
        yield from board_remarks(cell, settings, f"processes.{recipe.process}", folder)
        yield from look_remarks(cell, plugged, folder)
        yield from above_remarks(cell, plugged, key)
        yield from marks_remarks(plugged, key)
        yield from capture_remarks(plugged, key, folder)
        yield from holding_remarks(plugged, key, folder)
        yield from pitch_remarks(plugged, key, folder)
        yield from outline_remarks(plugged, key, folder)
        yield from taught_drawing_remarks(cell, plugged, key, folder)
        if settings.reference is not None:
            where = f"processes.{recipe.process}"
            yield from plate_side_remarks(settings.reference, where, folder)
        yield from uncalibrated_remarks(cell, plugged, folder)
        yield from tool_floor_remarks(cell, plugged.device(ARM), plugged.flange_T_plug)

    @classmethod
    def not_yet_checked(cls, cell: CellConfig, recipe: Recipe, folder: Path) -> Iterable[str]:
        """What only procedures 201 to 204, or the first look of a run, hold against the cell."""
        from cellctl.processes.antenna_module.checks.uncalibrated import not_yet_checked

        return not_yet_checked(cell, cast(AntennaRecipe, recipe), folder)

    @classmethod
    def moves(cls, cell: CellConfig, recipe: Recipe, folder: Path) -> Iterable[StatedMove]:
        """Those of a run, of the way back to its beginning, and of the procedures."""
        from cellctl.processes.antenna_module.moves.stated_moves import plugging_moves

        return plugging_moves(cell, cast(AntennaRecipe, recipe), folder)

    @classmethod
    def calibration_kinds(cls) -> "Kinds":
        """Intrinsics and mounting of both cameras, and what was taught."""
        from cellctl.processes.antenna_module.calibrations import CALIBRATIONS

        return CALIBRATIONS

    async def prepare(self, recipe: Recipe) -> "Prepared[PluggingFacts]":
        """Read calibrations and drawings, and compare them with what is connected."""
        from cellctl.processes.antenna_module.facts import read_facts

        plugged = cast(AntennaRecipe, recipe)
        facts = await read_facts(
            self.cell(plugged), plugged, self.services.calibrations, self.calibration_kinds()
        )
        return Prepared(facts, tuple(facts.calibrations.records))

    def open(self, prepared: "Prepared[PluggingFacts]", context: RunContext) -> "PluggingRun":
        """Facts, record, eyes and arm."""
        from cellctl.processes.antenna_module.run import PluggingRun

        return PluggingRun.of(prepared.facts, self.services, context, last_check=self._last_check)

    def required(self, run: "PluggingRun") -> "Sequence[RequiredFigure]":
        """The module in its place, the insertion, grip, mass and plan."""
        from cellctl.processes.antenna_module.record.required import required_figures
        from cellctl.processes.antenna_module.steps.contact import limits_of

        return required_figures(run, limits_of(run))

    async def begin(self, run: "PluggingRun") -> "GripperEmpty":
        """A module that may be plugged; gripper open and empty, arm at home."""
        from cellctl.processes.antenna_module.moves.start import move_to_start
        from cellctl.processes.antenna_module.quarantine import require_not_in_quarantine

        await require_not_in_quarantine(run.recorder)
        return await move_to_start(run)

    def steps(self, recipe: Recipe) -> "Steps[GripperEmpty, Any]":  # noqa: ARG002 - alike for all
        """Check reference, find, pick, inspect, locate, plan, stand-off, insert, verify."""
        from cellctl.processes.antenna_module.steps import PLUGGING

        return PLUGGING

    async def clear(self) -> None:
        """Up from tray and socket, home; a module in the gripper is the operator's."""
        from cellctl.processes.antenna_module.moves.start import leave_stations
        from cellctl.processes.antenna_module.stations import antenna_recipes

        recipes = antenna_recipes(self.services.cell.config)
        held: ModuleInGripper | None = None
        for recipe in first_of_each(recipes, FORCE):
            try:
                await leave_stations(self.cell(recipe))
            # The other arms leave their stations all the same.
            except ModuleInGripper as fault:
                held = fault
        if held is not None:
            raise held

    @classmethod
    def report(cls, record: RunRecord, read: ReadArtefact) -> ProcessPages:
        """Both connectors, what the plan rests on, force over depth."""
        from cellctl.processes.antenna_module.report.pages import pages

        return pages(record, read)

    def procedures(self) -> "Sequence[Procedure]":
        """What Maintenance offers: calibrations, the reference, the plug correction."""
        from cellctl.processes.antenna_module.procedures.procedure_list import antenna_procedures
        from cellctl.processes.antenna_module.stations import antenna_recipes

        recipes = antenna_recipes(self.services.cell.config)
        if not recipes:
            return ()
        return antenna_procedures(self.cell(recipes[0]), recipes, self.services)

    @classmethod
    def procedure_replays(cls) -> "Mapping[int, ProcedureReplay]":
        """What computes procedures anew from the images, poses and touches that their runs have
        kept."""
        from cellctl.processes.antenna_module.procedures.replays import REPLAYS

        return REPLAYS

    def cell(self, recipe: AntennaRecipe) -> "AntennaCell":
        """The devices in the roles of a recipe."""
        from cellctl.processes.antenna_module.stations import AntennaCell

        return AntennaCell.of(self.services.cell, recipe)
