"""The process: one deck is put onto one frame (paper, section 1.2)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import StatedModel
from cellctl.config.recipe import Recipe
from cellctl.config.stated.moves import StatedMove
from cellctl.errors.calibration import CalibrationError
from cellctl.processes.deck_to_frame.faults import SeatedOffPosition
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import (
    BOARD_TRANSFER_NAME,
    CONTACT_STIFFNESS_NAME,
    PAYLOAD_NAME,
    STOP_LATENCY_NAME,
)
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2, ROLES
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.records.entries import Calibration, RunRecord
from cellctl.records.replay.recorded_run import RecordedRun
from cellctl.records.replay.replayed import Replayed
from cellctl.records.report.sections import ProcessPages, ReadArtefact
from cellctl.runtime.procedure import Procedure, ProcedureReplay
from cellctl.runtime.process import CellServices, Prepared, Process, RunContext
from cellctl.runtime.steps import Steps

if TYPE_CHECKING:
    from cellctl.calibration.store.kind import Kinds
    from cellctl.config.stated.views import StatedMeasurement
    from cellctl.force.gravity.gravity_compensation import GravityCompensation
    from cellctl.processes.deck_to_frame.run import OpenRun
    from cellctl.processes.deck_to_frame.run_facts import RunFacts
    from cellctl.processes.deck_to_frame.state import Ready
    from cellctl.processes.deck_to_frame.stations import DeckCell
    from cellctl.records.required.required_figures import RequiredFigure

# What computes is imported where it is used: whoever only reads a cell file loads this module too,
# and an operator's command must not wait for vision and force.


class DeckToFrame(Process["RunFacts", "OpenRun", "Ready"]):
    """System A: measure frame and deck with two heads, correct, mate under force, verify."""

    name = "deck-to-frame"
    recipe_model = DeckRecipe
    settings_model = DeckSettings
    roles = ROLES
    stores = (
        HEAD_1,
        HEAD_2,
        "base_frame",
        BOARD_TRANSFER_NAME,
        PAYLOAD_NAME,
        STOP_LATENCY_NAME,
        CONTACT_STIFFNESS_NAME,
    )
    spoiled_by = frozenset({SeatedOffPosition})

    def __init__(self, services: CellServices) -> None:
        from cellctl.processes.deck_to_frame.procedures.board_transfer import WaitingPlacements
        from cellctl.processes.deck_to_frame.stations import FrameMemory

        super().__init__(services)
        self._memory = FrameMemory()
        self._waiting = WaitingPlacements()
        # A board that was seen through the old calibration of a head must not be combined with one
        # seen through the new.
        services.calibrations.on_stored.append(self._waiting.drop)
        services.calibrations.on_invalidated.append(self._waiting.clear)

    @classmethod
    def check(
        cls, cell: CellConfig, recipe: Recipe, key: str, folder: Path
    ) -> Iterable[ConfigIssue]:
        """Feature files, and whether the recipe's figures give a mating plan."""
        from cellctl.processes.deck_to_frame.checks.recipe import recipe_issues

        return recipe_issues(cell, cast(DeckRecipe, recipe), key, folder)

    @classmethod
    def check_plausible(
        cls, cell: CellConfig, recipe: Recipe, key: str, folder: Path
    ) -> Iterable[ConfigIssue]:
        """Figures and poses that fit their own keys and not each other."""
        from cellctl.processes.deck_to_frame.checks.plausible.findings import plausible_issues

        return plausible_issues(cell, cast(DeckRecipe, recipe), key, folder)

    @classmethod
    def check_placed(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        key: str,
        folder: Path,
        bases: Mapping[str, Sequence[float]],
    ) -> Iterable[ConfigIssue]:
        """Whether the heads see the holes that they are to measure, and zones keep them apart."""
        from cellctl.processes.deck_to_frame.checks.plausible.seen_holes import sight_issues
        from cellctl.processes.deck_to_frame.checks.shared_zones import shared_zone_issues

        deck, settings = cast(DeckRecipe, recipe), cell.processes[recipe.process]
        yield from sight_issues(cell, deck, key, folder, bases)
        yield from shared_zone_issues(cell, deck, cast(DeckSettings, settings), bases)

    @classmethod
    def check_model(
        cls, cell: CellConfig, recipe: Recipe, key: str, model: StatedModel
    ) -> Iterable[ConfigIssue]:
        """Whether the bodies of deck and frame hold the parts of the recipe."""
        from cellctl.processes.deck_to_frame.checks.modelled_parts import modelled_part_issues

        return modelled_part_issues(cell, cast(DeckRecipe, recipe), key, model)

    @classmethod
    def remarks(
        cls, cell: CellConfig, recipe: Recipe, key: str, folder: Path
    ) -> Iterable[ConfigIssue]:
        """Holes of a head on one line, another board or load than in the stored calibrations."""
        from cellctl.processes.deck_to_frame.checks.plausible.remarks import recipe_remarks

        return recipe_remarks(cell, cast(DeckRecipe, recipe), key, folder)

    @classmethod
    def moves(
        cls,
        cell: CellConfig,
        recipe: Recipe,
        folder: Path,  # noqa: ARG003 - the recipe says all
    ) -> Iterable[StatedMove]:
        """Those of a run, of the way back to its beginning, and of the procedures."""
        from cellctl.processes.deck_to_frame.stated_moves import deck_moves

        return deck_moves(cell, cast(DeckRecipe, recipe))

    @classmethod
    def measurements(
        cls, cell: CellConfig, recipe: Recipe, folder: Path
    ) -> "Iterable[StatedMeasurement]":
        """Frame and deck, each by both heads."""
        from cellctl.processes.deck_to_frame.stated_views import deck_measurements

        return deck_measurements(cell, cast(DeckRecipe, recipe), folder)

    @classmethod
    def calibration_kinds(cls) -> "Kinds":
        """Heads, base frame, board transfer, payload, and what commissioning measures."""
        from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS

        return CALIBRATIONS

    async def prepare(self, recipe: Recipe) -> "Prepared[RunFacts]":
        """Read calibrations and drawings, and compare them with what is connected."""
        from cellctl.processes.deck_to_frame.run_facts import read_facts

        deck_recipe = cast(DeckRecipe, recipe)
        facts = await read_facts(
            self.cell(deck_recipe),
            deck_recipe,
            self.services.calibrations,
            self.calibration_kinds(),
        )
        return Prepared(facts, tuple(facts.calibrations.records))

    def open(self, prepared: "Prepared[RunFacts]", context: RunContext) -> "OpenRun":
        """Facts, record and the way to tell of progress."""
        from cellctl.processes.deck_to_frame.run import OpenRun

        return OpenRun.of(prepared.facts, self.services, context)

    def required(self, run: "OpenRun") -> "Sequence[RequiredFigure]":
        """Seat, mating, errors before it, and the fit of every measurement."""
        from cellctl.processes.deck_to_frame.record.required import required_figures

        return required_figures(run.facts)

    async def begin(self, run: "OpenRun") -> "Ready":
        """The deck clear of the station, the heads over it; these count as unmoved from here on."""
        from cellctl.processes.deck_to_frame.moves.move_to_start import move_to_start

        return await move_to_start(run)

    def steps(self, recipe: Recipe) -> "Steps[Ready, Any]":  # noqa: ARG002 - alike for all
        """Measure frame, measure deck, pre-assembly, correct pose, mate, verify."""
        from cellctl.processes.deck_to_frame.steps import ASSEMBLY

        return ASSEMBLY

    async def clear(self) -> None:
        """Lift the deck off the station, wherever a recipe's deck would be low over its frame."""
        from cellctl.processes.deck_to_frame.moves.lift_off import lift_off

        payload = self._payload_or_none()
        for cell in self._cells():
            await lift_off(cell, payload)

    async def show_contact_force(self) -> None:
        """Less the payload that was identified last; of a deck on its frame in the deck's axes."""
        from cellctl.processes.deck_to_frame.calibrations import PAYLOAD
        from cellctl.processes.deck_to_frame.moves.force_on_deck import show_force_on_deck

        payload = self.services.calibrations.read(PAYLOAD)
        for cell in self._cells():
            await show_force_on_deck(cell, payload.gravity_compensation)

    @classmethod
    def report(cls, record: RunRecord, read: ReadArtefact) -> ProcessPages:
        """Holes, the loop, forces over time and travel, pin holes."""
        from cellctl.processes.deck_to_frame.report.pages import pages

        return pages(record, read)

    @classmethod
    def replay(
        cls, record: RunRecord, read: ReadArtefact, calibrations: Mapping[str, Calibration]
    ) -> Iterator[Replayed]:
        """Poses from the raw images, what followed from them, the peaks of the force, and of
        procedure 108 the stiffness."""
        from cellctl.processes.deck_to_frame.procedures.replays import replay_stiffness
        from cellctl.processes.deck_to_frame.record.replay import replay

        run = RecordedRun(record, read, calibrations)
        return chain(replay(record, read, calibrations), replay_stiffness(run))

    def procedures(self) -> Sequence[Procedure]:
        """Calibration and commissioning, 101 to 109."""
        from cellctl.processes.deck_to_frame.procedures.procedure_list import deck_procedures

        # The cell's measurements belong to its devices: they are offered once, with those of the
        # first recipe.
        cell = next(iter(self._cells()), None)
        return () if cell is None else deck_procedures(cell, self.services, self._waiting)

    def _payload_or_none(self) -> "GravityCompensation | None":
        """The payload that was identified last; None where it is not valid.

        A Reset can do without it, but knows less of what pulls at the arm after a restart.
        """
        from cellctl.processes.deck_to_frame.calibrations import PAYLOAD

        try:
            return self.services.calibrations.read(PAYLOAD).gravity_compensation
        except CalibrationError:
            return None

    @classmethod
    def procedure_replays(cls) -> Mapping[int, ProcedureReplay]:
        """What computes procedures anew from the images, targets, wrenches and stops of their
        runs."""
        from cellctl.processes.deck_to_frame.procedures.replays import REPLAYS

        return REPLAYS

    def cell(self, recipe: DeckRecipe) -> "DeckCell":
        """The devices in the roles of a recipe."""
        from cellctl.processes.deck_to_frame.stations import DeckCell

        return DeckCell.of(self.services.cell, recipe, self._memory)

    def _cells(self) -> "Iterable[DeckCell]":
        """Each set of devices that recipes use, once."""
        from cellctl.processes.deck_to_frame.stations import deck_recipes

        recipes = deck_recipes(self.services.cell.config)
        # Two recipes that use the same devices share one arm: it is lifted off once, looking at all
        # of their stations.
        bound = {tuple(recipe.device(role) for role in ROLES): recipe for recipe in recipes}
        return [self.cell(recipe) for recipe in bound.values()]
