"""What every step of one insertion works with: devices, plan, recording."""

from dataclasses import dataclass
from typing import Self

from cellctl.cell.contact_motion.settings import ContactSettings
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.cycle import CyclePlan
from cellctl.processes.peg_in_hole.panel_reference import PanelReference
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.process import RunContext
from cellctl.runtime.progress import ProgressBoard

_FOLLOW_MARGIN_M = 2e-3
"""How far beyond the depth of its hole the tip may follow a press before the loop counts as
saturated."""
_MS = 1e-3


@dataclass(frozen=True, slots=True)
class PegFacts:
    """What is known before a run."""

    cell: PegCell
    recipe: PegRecipe
    plan: CyclePlan
    contact: ContactSettings
    panel: PanelReference | None = None
    """Where the face was met before; None where nothing is compared."""

    @classmethod
    def of(cls, cell: PegCell, recipe: PegRecipe, plan: CyclePlan) -> Self:
        """Raises ``LoopTooSlow`` or ``LoopUnstable``: the arm could not be let follow a force."""
        settings = contact_settings(recipe, plan, cell.settings)
        settings.check()
        return cls(cell, recipe, plan, settings)


def contact_settings(recipe: PegRecipe, plan: CyclePlan, settings: PegSettings) -> ContactSettings:
    """What the streamed contact of a cycle is given."""
    task, lost_ms = plan.task, settings.lost_tick_ms
    return ContactSettings(
        figures=LoopFigures(task.cell.stiffness_n_m, task.cell.dead_time_s),
        lever_m=task.fit.peg_radius_m,
        press_n=plan.choice.parameters.press_n.value,
        limit_n=task.limits.fault_n,
        limit_n_m=task.limits.fault_n_m,
        follow_m=recipe.fit.depth_mm * MM + _FOLLOW_MARGIN_M,
        lost_tick_s=None if lost_ms is None else lost_ms * _MS,
        old_force_s=settings.old_force_ms * _MS,
        lost_force_s=settings.lost_force_ms * _MS,
    )


@dataclass(frozen=True, slots=True)
class PegRun:
    """One open run."""

    facts: PegFacts
    board: ProgressBoard
    recorder: RunRecorder

    @classmethod
    def of(cls, facts: PegFacts, board: ProgressBoard, context: RunContext) -> Self:
        """A run whose record was opened."""
        return cls(facts, board, context.recorder)

    def say(self, message: str) -> None:
        """Tell line and terminal what is being done."""
        self.board.update(message=message)
