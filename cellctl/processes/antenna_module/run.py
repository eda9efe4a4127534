"""What every step of one plugging works with: devices, facts, looking, moving, recording."""

from dataclasses import dataclass, field
from typing import Self

from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.processes.antenna_module.drawings import Drawings
from cellctl.processes.antenna_module.facts import PluggingFacts
from cellctl.processes.antenna_module.last_check import LastCheck
from cellctl.processes.antenna_module.looking import Eyes, measured_channel
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.process import CellServices, RunContext
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.steps import SafePoint


@dataclass(frozen=True, slots=True)
class PluggingRun:
    """One open run, however often its steps begin anew after a Hold."""

    facts: PluggingFacts
    board: ProgressBoard
    recorder: RunRecorder
    safe_point: SafePoint
    interruption: Interruption
    eyes: Eyes
    mover: Mover
    last_check: LastCheck
    second_looks: list[str] = field(default_factory=list)
    """Names of the looks that were taken a second time."""
    prefix: str = ""
    """Before the names of files and entries, where one run plugs several times."""

    @classmethod
    def of(
        cls,
        facts: PluggingFacts,
        services: CellServices,
        context: RunContext,
        *,
        last_check: LastCheck | None = None,
        prefix: str = "",
        keep_images: bool = True,
    ) -> Self:
        """A run whose record was opened; ``keep_images``: raw ones belong into the record."""
        cell = facts.cell
        return cls(
            facts,
            services.board,
            context.recorder,
            context.safe_point,
            context.interruption,
            Eyes(
                cell.arm,
                cell.workers,
                context.recorder if keep_images else None,
                facts.recipe.frames,
                RunExposures(cell.cell, context.recorder, measured_channel),
            ),
            Mover(cell),
            LastCheck() if last_check is None else last_check,
            prefix=prefix,
        )

    @property
    def cell(self) -> AntennaCell:
        """The devices."""
        return self.facts.cell

    @property
    def recipe(self) -> AntennaRecipe:
        """What is plugged."""
        return self.facts.recipe

    @property
    def drawings(self) -> Drawings:
        """Its connectors and marks."""
        return self.facts.drawings

    def say(self, message: str) -> None:
        """Tell line and terminal what is being done."""
        self.board.update(message=message)
