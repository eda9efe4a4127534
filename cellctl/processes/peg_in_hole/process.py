"""The process: a peg finds its hole by touch and is inserted (study of insertion by touch)."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import StatedModel
from cellctl.config.recipe import Recipe, first_of_each
from cellctl.config.stated.moves import StatedMove
from cellctl.processes.peg_in_hole.faults import (
    HoleAbsent,
    HoleBlocked,
    PegJammed,
    PegNotInserted,
    PegWedged,
)
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import FORCE, ROLES
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.records.entries import RunRecord
from cellctl.records.report.sections import ProcessPages, ReadArtefact
from cellctl.runtime.process import Prepared, Process, RunContext
from cellctl.runtime.steps import Steps

if TYPE_CHECKING:
    from cellctl.calibration.store.kind import Kinds
    from cellctl.processes.peg_in_hole.run import PegFacts, PegRun
    from cellctl.processes.peg_in_hole.state import AtHome
    from cellctl.processes.peg_in_hole.stations import PegCell
    from cellctl.records.required.required_figures import RequiredFigure
    from cellctl.runtime.procedure import Procedure

# What computes is imported where it is used: whoever only reads a cell file loads this module too,
# and an operator's command must not wait for searches and force.


class PegInHole(Process["PegFacts", "PegRun", "AtHome"]):
    """System C: approach, touch the face, search, insert, verify."""

    name = "peg-in-hole"
    no_replay = (
        "has every tick, and not which of them a touch, a chirp or a step was computed from; the "
        "curve of an insertion is judged anew by `cellctl judge-insertion`"
    )
    recipe_model = PegRecipe
    settings_model = PegSettings
    roles = ROLES
    stores = ("contact_loop", "panel_reference")
    spoiled_by = frozenset({PegNotInserted, PegJammed, PegWedged, HoleBlocked, HoleAbsent})

    @classmethod
    def check(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        key: str,
        folder: Path,  # noqa: ARG003 - no files
    ) -> Iterable[ConfigIssue]:
        """Devices on the same arm, and a task that a search can solve."""
        from cellctl.processes.peg_in_hole.checks import recipe_issues

        return recipe_issues(cell, cast(PegRecipe, recipe), key)

    @classmethod
    def check_plausible(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        key: str,
        folder: Path,
    ) -> Iterable[ConfigIssue]:
        """Figures and poses that fit their own keys and not each other."""
        from cellctl.processes.peg_in_hole.plausible.findings import plausible_issues

        return plausible_issues(cell, cast(PegRecipe, recipe), key, folder)

    @classmethod
    def check_model(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,
        key: str,
        model: StatedModel,
    ) -> Iterable[ConfigIssue]:
        """Whether a body has the hole."""
        from cellctl.processes.peg_in_hole.plausible.modelled_hole import modelled_hole_issues

        return modelled_hole_issues(cast(PegRecipe, recipe), key, model)

    @classmethod
    def remarks(
        cls, cell: CellConfig, recipe: Recipe, key: str, folder: Path
    ) -> Iterable[ConfigIssue]:
        """A wide fit, keys that need no turn, an arm that is softer than most."""
        from cellctl.processes.peg_in_hole.plausible.remarks import recipe_remarks

        return recipe_remarks(cell, cast(PegRecipe, recipe), key, folder)

    @classmethod
    def not_yet_checked(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,
        folder: Path,  # noqa: ARG003
    ) -> Iterable[str]:
        """What only the first touch of the face shows."""
        from cellctl.processes.peg_in_hole.plausible.remarks import not_yet_checked

        return not_yet_checked(cast(PegRecipe, recipe))

    @classmethod
    def moves(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        folder: Path,  # noqa: ARG003 - the recipe says all
    ) -> Iterable[StatedMove]:
        """Those of a run and of the way back to its beginning; the procedures make the same."""
        from cellctl.processes.peg_in_hole.plan.stated_moves import peg_moves

        return peg_moves(cell, cast(PegRecipe, recipe))

    @classmethod
    def calibration_kinds(cls) -> "Kinds":
        """The measured loop; without it the bounds of the settings count."""
        from cellctl.processes.peg_in_hole.calibrations import CALIBRATIONS

        return CALIBRATIONS

    async def prepare(self, recipe: Recipe) -> "Prepared[PegFacts]":
        """Choose the search and refuse a task or a loop that cannot be held."""
        from cellctl.processes.peg_in_hole.facts import read_facts

        peg = cast(PegRecipe, recipe)
        return await read_facts(self.cell(peg), peg, self.services.calibrations)

    def open(self, prepared: "Prepared[PegFacts]", context: RunContext) -> "PegRun":
        """Facts, record and board."""
        from cellctl.processes.peg_in_hole.run import PegRun

        return PegRun.of(prepared.facts, self.services.board, context)

    def required(self, run: "PegRun") -> "Sequence[RequiredFigure]":
        """Every item of the verdict, and the force of the insertion."""
        from cellctl.processes.peg_in_hole.record.required import required_figures

        return required_figures(run.facts.plan)

    async def begin(self, run: "PegRun") -> "AtHome":
        """The arm at home, out of the hole first."""
        from cellctl.processes.peg_in_hole.leaving import leave_hole
        from cellctl.processes.peg_in_hole.state import AtHome

        run.say("to the beginning")
        await leave_hole(run.facts.cell)
        return AtHome(run)

    def steps(self, recipe: Recipe) -> "Steps[AtHome, Any]":  # noqa: ARG002 - alike for all
        """Approach, touch the face, search and insert."""
        from cellctl.processes.peg_in_hole.steps import INSERTION

        return INSERTION

    async def clear(self) -> None:
        """Out of the hole along its axis, home; the part comes along."""
        from cellctl.processes.peg_in_hole.leaving import leave_hole

        for cell in self._cells():
            await leave_hole(cell)

    async def show_contact_force(self) -> None:
        """Less part and gripper by the recipe; of a tip in its hole in the tip's axes."""
        from cellctl.processes.peg_in_hole.leaving import show_force_on_tip

        for cell in self._cells():
            await show_force_on_tip(cell)

    @classmethod
    def report(cls, record: RunRecord, read: ReadArtefact) -> ProcessPages:
        """The search on its face, force over depth, every item of the verdict."""
        from cellctl.processes.peg_in_hole.report.pages import pages

        return pages(record, read)

    def procedures(self) -> "Sequence[Procedure]":
        """Procedure 301 measures the loop."""
        from cellctl.processes.peg_in_hole.procedures.procedure_list import peg_procedures
        from cellctl.processes.peg_in_hole.stations import peg_recipes

        recipes = peg_recipes(self.services.cell.config)
        if not recipes:
            return ()
        return peg_procedures(self.cell(recipes[0]), recipes, self.services)

    def cell(self, recipe: PegRecipe) -> "PegCell":
        """The devices in the roles of a recipe."""
        from cellctl.processes.peg_in_hole.stations import PegCell

        return PegCell.of(self.services.cell, recipe)

    def _cells(self) -> "list[PegCell]":
        """Each arm that recipes use, once."""
        from cellctl.processes.peg_in_hole.stations import peg_recipes

        recipes = peg_recipes(self.services.cell.config)
        return [self.cell(recipe) for recipe in first_of_each(recipes, FORCE)]
